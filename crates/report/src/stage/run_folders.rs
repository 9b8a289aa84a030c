//! Run folders on the command line: where one page leads to another.

use std::path::Path;

/// The address of a file as seen from the folder of a page; `None` where the file is not there.
pub fn address(page: &Path, file: &Path) -> Option<String> {
    let from = page.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (from, to) = (from.canonicalize().ok()?, file.canonicalize().ok()?);
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let up = from.components().skip(shared).map(|_| "..".to_owned());
    let down = to.components().skip(shared).map(|part| part.as_os_str().to_string_lossy().into_owned());
    Some(up.chain(down).collect::<Vec<_>>().join("/"))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn an_address_leads_from_the_page_to_the_file() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join("runs/a b")).unwrap();
        let report = folder.path().join("runs/a b/report.html");
        fs::write(&report, "").unwrap();
        assert_eq!(address(&folder.path().join("index.html"), &report).as_deref(), Some("runs/a b/report.html"));
        let page = folder.path().join("runs/pages/index.html");
        fs::create_dir(page.parent().unwrap()).unwrap();
        assert_eq!(address(&page, &report).as_deref(), Some("../a b/report.html"));
        assert_eq!(address(&page, &folder.path().join("absent")), None);
    }
}

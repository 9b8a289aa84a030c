//! Run folders on the command line: what is in them, what they are called, where one page leads to another.

use std::fs;
use std::path::{Component, Path, PathBuf};

use anyhow::Context;
use crumple_stage::Refused;

/// The artifacts in a run folder, by name. Refuses a folder without any.
pub fn artifacts_in(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).with_context(|| format!("cannot read the folder {}", folder.display()));
    let entries = entries.map_err(|error| {
        Refused::new(format!("{error:#}")).expected("a run folder").hint("name folders that just run made")
    })?;
    let mut artifacts = Vec::new();
    for entry in entries {
        let path = entry.with_context(|| format!("cannot read the folder {}", folder.display()))?.path();
        // A stage that was killed may leave a hidden temporary file.
        let is_hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if !is_hidden && path.extension().is_some_and(|extension| extension == "mcap") {
            artifacts.push(path);
        }
    }
    artifacts.sort();
    if artifacts.is_empty() {
        return Err(Refused::new(format!("{} holds no artifact (*.mcap)", folder.display()))
            .expected("a run folder")
            .hint("name folders that just run made, such as runs/crash/default")
            .into());
    }
    Ok(artifacts)
}

/// The folders by what tells them apart: their paths without the folders that all begin with and the names that all
/// end with.
pub fn names(folders: &[PathBuf]) -> Vec<String> {
    let parts = |folder: &PathBuf| -> Vec<String> {
        let named = folder.components().filter(|part| !matches!(part, Component::CurDir));
        named.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect()
    };
    let mut all: Vec<Vec<String>> = folders.iter().map(parts).collect();
    let same = |all: &[Vec<String>], at: fn(&Vec<String>) -> Option<&String>| {
        all.iter().all(|parts| parts.len() > 1 && at(parts) == at(&all[0]))
    };
    while same(&all, |parts| parts.first()) {
        all.iter_mut().for_each(|parts| _ = parts.remove(0));
    }
    while same(&all, |parts| parts.last()) {
        all.iter_mut().for_each(|parts| _ = parts.pop());
    }
    all.into_iter().map(|parts| parts.join("/")).collect()
}

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
    use super::*;

    #[test]
    fn folders_are_called_by_what_tells_them_apart() {
        let of = |folders: &[&str]| names(&folders.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(of(&["runs/a/default", "runs/b/default"]), ["a", "b"]);
        assert_eq!(of(&["runs/a/default/", "./runs/a/unfiltered"]), ["default", "unfiltered"]);
        assert_eq!(of(&["a", "a/x"]), ["a", "a/x"]);
        assert_eq!(of(&["a", "a"]), ["a", "a"]);
    }

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

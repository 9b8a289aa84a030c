//! Whether the results in a folder are those of a run.

use std::path::Path;

use crumple_stage::Usage;

use crate::folder::content::{Content, content_of, is_artifact};

/// Refuses a folder whose files have names of outputs and are not: a run removes and replaces such files.
///
/// A run removes the report first and the artifacts after it, so its report never stands alone; and its artifacts are
/// MCAP files.
pub(crate) fn refuse_files_of_others<'a>(folder: &Path, outputs: impl Iterator<Item = &'a str>) -> Result<(), Usage> {
    let (artifacts, reports): (Vec<&str>, Vec<&str>) = outputs.partition(|name| is_artifact(name));
    let refused = |what: String| {
        let problem = format!("{what} in {}; a run would replace it, and nothing was run", folder.display());
        Err(Usage::new(problem).hint("choose another folder: just out=DIR run RECORD; or move the file away"))
    };
    if let Some(other) = artifacts.iter().find(|name| content_of(&folder.join(name)) == Content::Other) {
        return refused(format!("{other} is no artifact (no MCAP file)"));
    }
    let has_artifact = artifacts.iter().any(|name| folder.join(name).exists());
    match reports.iter().find(|name| folder.join(name).exists()) {
        Some(report) if !has_artifact => refused(format!("{report} stands without an artifact of a run")),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_report_without_artifacts_and_artifacts_of_others_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, content: &[u8]| fs::write(folder.path().join(name), content).unwrap();
        let refused = || {
            refuse_files_of_others(folder.path(), ["1-ingest.mcap", "report.html", "summary.json"].into_iter())
                .map_err(|error| error.to_string())
        };
        assert_eq!(refused(), Ok(()));
        write("summary.json", b"{}");
        assert!(refused().unwrap_err().starts_with("summary.json stands without an artifact"), "{:?}", refused());
        write("1-ingest.mcap", b"\x89MCAP0\r\n");
        assert_eq!(refused(), Ok(()));
        write("1-ingest.mcap", b"text");
        assert!(refused().unwrap_err().starts_with("1-ingest.mcap is no artifact"), "{:?}", refused());
    }
}

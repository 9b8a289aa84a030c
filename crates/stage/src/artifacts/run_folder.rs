//! The artifacts in the folder of a run.

use std::path::{Path, PathBuf};

use crate::error::Refused;

/// The artifacts of a run folder, in the order of their stages. Refuses a folder without any.
pub fn artifacts_of_a_run(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let refused = |problem: String| {
        Refused::new(problem)
            .expected("the folder of a run, with 1-ingest.mcap and what was made from it")
            .hint("just run RECORD makes one, and says where it is")
    };
    let cannot = |error: std::io::Error| refused(format!("cannot read the folder {}: {error}", folder.display()));
    let mut artifacts = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(cannot)? {
        let path = entry.map_err(cannot)?.path();
        // A stage that was killed may leave a hidden temporary file.
        let is_hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if !is_hidden && path.extension().is_some_and(|ending| ending == "mcap") {
            artifacts.push(path);
        }
    }
    artifacts.sort();
    if artifacts.is_empty() {
        return Err(refused(format!("{} holds no artifact", folder.display())).into());
    }
    Ok(artifacts)
}

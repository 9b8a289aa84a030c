//! What a run that was killed leaves in the folder.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Folder inside the run folder in which programs from elsewhere write.
const NEW: &str = ".new";

/// Where a program from elsewhere writes before its result is taken over.
pub(crate) fn folder_of_new_results(folder: &Path) -> PathBuf {
    folder.join(NEW)
}

/// Removes the temporary files of the outputs and the results that were never taken over. Only under the lock: nobody
/// else writes here.
pub(crate) fn sweep<'a>(folder: &Path, outputs: impl Iterator<Item = &'a str>) -> io::Result<()> {
    match fs::remove_dir_all(folder_of_new_results(folder)) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    // What is written whole or not at all is first called so.
    let starts: Vec<String> = outputs.map(|name| format!(".{name}.")).collect();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.ends_with(".tmp") && starts.iter().any(|start| name.starts_with(start)) {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_a_killed_run_left_goes() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir(path(".new")).unwrap();
        for name in [".new/1-ingest.mcap", ".1-ingest.mcap.aBc123.tmp", "1-ingest.mcap", ".mine.tmp", "notes.txt"] {
            fs::write(path(name), "x").unwrap();
        }
        sweep(folder.path(), ["1-ingest.mcap"].into_iter()).unwrap();
        let mut names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, [".mine.tmp", "1-ingest.mcap", "notes.txt"]);
    }
}

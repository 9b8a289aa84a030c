//! What a run that was killed leaves in the folder.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Folder inside the run folder in which programs from elsewhere write.
const NEW: &str = ".crumple-run.new";

/// Where a program from elsewhere writes before its result is taken over.
pub(crate) fn folder_of_new_results(folder: &Path) -> PathBuf {
    folder.join(NEW)
}

/// Removes the temporary files of the outputs and the results that were never taken over; what has another name stays.
/// Only under the lock: nobody else writes here.
pub(crate) fn sweep<'a>(folder: &Path, outputs: impl Iterator<Item = &'a str>) -> io::Result<()> {
    let outputs: Vec<&str> = outputs.collect();
    remove_files(folder, |name| is_temporary(name, &outputs))?;
    let new = folder_of_new_results(folder);
    // A link to a folder elsewhere is not what a run leaves.
    if fs::symlink_metadata(&new).is_ok_and(|found| found.is_dir()) {
        remove_files(&new, |name| outputs.contains(&name) || is_temporary(name, &outputs))?;
        match fs::remove_dir(&new) {
            Err(error) if error.kind() != io::ErrorKind::DirectoryNotEmpty => return Err(error),
            _ => {}
        }
    }
    Ok(())
}

/// Whether it is what an output is called before it is whole.
fn is_temporary(name: &str, outputs: &[&str]) -> bool {
    let of = |output: &&str| name.strip_prefix('.').and_then(|rest| rest.strip_prefix(output));
    name.ends_with(".tmp") && outputs.iter().filter_map(of).any(|rest| rest.starts_with('.'))
}

fn remove_files(folder: &Path, is_meant: impl Fn(&str) -> bool) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if is_meant(&entry.file_name().to_string_lossy()) && !entry.file_type()?.is_dir() {
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
        let new = folder_of_new_results(folder.path());
        fs::create_dir(&new).unwrap();
        for name in [".1-ingest.mcap.aBc123.tmp", "1-ingest.mcap", ".mine.tmp", "notes.txt"] {
            fs::write(path(name), "x").unwrap();
        }
        for name in ["1-ingest.mcap", ".1-ingest.mcap.x.tmp", "mine.txt"] {
            fs::write(new.join(name), "x").unwrap();
        }
        let sweep = || sweep(folder.path(), ["1-ingest.mcap"].into_iter()).unwrap();
        sweep();
        let left: Vec<_> = fs::read_dir(&new).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(left, ["mine.txt"]);
        fs::remove_file(new.join("mine.txt")).unwrap();
        sweep();
        let mut names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, [".mine.tmp", "1-ingest.mcap", "notes.txt"]);
    }
}

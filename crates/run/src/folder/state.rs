//! The state of a whole run: what it left, and the programs that made it.

use std::fs::{self, File};
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

/// Digest of every byte of the results, and of which file each program is; an error where one of them is missing.
///
/// A program is known by its place on the disk, its size and the times of its content and of its inode: the system sets
/// the last one, so that no copy or edit passes for it.
pub(crate) fn state_of<'a>(
    folder: &Path,
    results: impl Iterator<Item = &'a str>,
    programs: &[PathBuf],
) -> io::Result<String> {
    let mut state = blake3::Hasher::new();
    for name in results {
        let mut content = blake3::Hasher::new();
        content.update_reader(File::open(folder.join(name))?)?;
        state.update(format!("{name} {}\n", content.finalize().to_hex()).as_bytes());
    }
    for program in programs {
        let file = fs::metadata(program)?;
        let times = [file.mtime(), file.mtime_nsec(), file.ctime(), file.ctime_nsec()];
        let known = format!("{} {} {} {} {times:?}\n", program.display(), file.dev(), file.ino(), file.size());
        state.update(known.as_bytes());
    }
    Ok(format!("blake3:{}", state.finalize().to_hex()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_of_a_result_and_another_program_of_the_same_size_are_seen() {
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("program");
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write("a", "1");
        write("program", "x");
        let state = || state_of(folder.path(), ["a"].into_iter(), std::slice::from_ref(&program)).ok();
        let first = state().unwrap();
        assert_eq!(state(), Some(first.clone()));
        write("a", "2");
        assert_ne!(state(), Some(first.clone()));
        write("a", "1");
        assert_eq!(state(), Some(first.clone()));
        fs::remove_file(&program).unwrap();
        assert_eq!(state(), None);
        write("b", "y");
        write("program", "x");
        assert_ne!(state(), Some(first));
    }
}

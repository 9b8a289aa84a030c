//! One run at a time in a folder, by a lock that dies with its last holder.

use std::fs::{self, File, TryLockError};
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_stage::{Usage, say};
use rustix::io::{FdFlags, fcntl_setfd};

use crate::folder::holder::holder_of;

/// A run folder that no other run works in.
///
/// The folder itself is locked, so no file stays behind. The programs started here inherit the lock: where this process
/// is killed, the folder is free once the stage that it started has ended too.
#[derive(Debug)]
pub(crate) struct LockedFolder {
    path: PathBuf,
    /// Folders that did not exist before, innermost first.
    made: Vec<PathBuf>,
    file: File,
}

impl LockedFolder {
    /// Makes the folder where there is none, and waits while another run works in it, saying for whom.
    pub(crate) fn lock(path: &Path) -> anyhow::Result<Self> {
        let made: Vec<PathBuf> = path.ancestors().take_while(|p| !p.exists()).map(Path::to_owned).collect();
        loop {
            fs::create_dir_all(path).map_err(|error| {
                Usage::new(format!("cannot make the run folder {}: {error}", path.display()))
                    .hint("say where to: just out=DIR run RECORD")
            })?;
            let file = File::open(path).with_context(|| format!("cannot open the run folder {}", path.display()))?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    say(format_args!(
                        "waiting for {} in {} (another folder does not wait: just out=DIR run RECORD)",
                        holder_of(path),
                        path.display()
                    ));
                    file.lock().with_context(|| format!("cannot lock the run folder {}", path.display()))?;
                }
                Err(TryLockError::Error(error)) => say(format_args!(
                    "note: {} cannot be locked ({error}): start no second run into it before this one has ended",
                    path.display()
                )),
            }
            // Whoever held the lock may have removed the folder, and a third made it again.
            if is_at(&file, path) {
                // Children hold the lock too: by default they would close it.
                fcntl_setfd(&file, FdFlags::empty()).context("cannot pass the lock on to the stages")?;
                return Ok(Self { path: path.to_owned(), made, file });
            }
        }
    }

    /// Its path.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for LockedFolder {
    fn drop(&mut self) {
        // Nothing was written: the folders that were made for it go too. One that holds something stays.
        for folder in &self.made {
            if fs::remove_dir(folder).is_err() {
                break;
            }
        }
        // Also for children that a stage may have left running.
        let _ = self.file.unlock();
    }
}

/// Whether a path still leads to an open file.
pub(crate) fn is_at(file: &File, path: &Path) -> bool {
    let id = |metadata: io::Result<fs::Metadata>| metadata.ok().map(|m| (m.dev(), m.ino()));
    let open = id(file.metadata());
    open.is_some() && open == id(fs::metadata(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_leaves_no_trace_and_keeps_what_was_there() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a/b");
        drop(LockedFolder::lock(&path).unwrap());
        assert!(!root.path().join("a").exists());
        {
            let locked = LockedFolder::lock(&path).unwrap();
            assert!(matches!(File::open(&path).unwrap().try_lock(), Err(TryLockError::WouldBlock)));
            fs::write(locked.path().join("result"), "x").unwrap();
        }
        assert!(File::open(&path).unwrap().try_lock().is_ok());
        drop(LockedFolder::lock(&path).unwrap());
        assert!(path.join("result").exists());
    }

    #[test]
    fn a_run_folder_that_is_a_file_is_refused() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("file");
        fs::write(&path, "x").unwrap();
        let error = LockedFolder::lock(&path).unwrap_err();
        assert!(error.to_string().starts_with("cannot make the run folder"), "{error}");
    }
}

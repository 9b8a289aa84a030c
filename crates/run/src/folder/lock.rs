//! One run at a time in a folder, by a lock that dies with its last holder.

use std::fs::{self, File, TryLockError};
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_stage::{Usage, say};
use rustix::io::{FdFlags, fcntl_setfd};

use crate::folder::holder::holder_of;

/// Stands in the run folder while a run works there, where the file system does not lock folders.
const LOCK_FILE: &str = ".crumple-run.lock";

/// How often a folder may go between being made and being opened: another run that failed removes what it made.
const TRIES: u32 = 100;

/// A run folder that no other run works in.
///
/// The folder itself is locked, so no file stays behind; where the file system refuses that, a file in it. The programs
/// started here inherit the lock: where this process is killed, the folder is free once the stage that it started has
/// ended too.
#[derive(Debug)]
pub(crate) struct LockedFolder {
    path: PathBuf,
    /// Folders that did not exist before, innermost first.
    made: Vec<PathBuf>,
    lock: Lock,
}

/// What is locked.
#[derive(Debug)]
enum Lock {
    Folder(File),
    FileInIt(File),
    Nothing,
}

impl LockedFolder {
    /// Makes the folder where there is none, and waits while another run works in it, saying for whom.
    pub(crate) fn lock(path: &Path) -> anyhow::Result<Self> {
        let made = path.ancestors().take_while(|p| !p.exists()).map(Path::to_owned).collect();
        let folder = loop {
            let folder = made_and_opened(path)?;
            match lock_or_wait(&folder, path, path) {
                // Whoever held the lock may have removed the folder, and a third made it again.
                Ok(()) if !is_at(&folder, path) => {}
                Ok(()) => break Lock::Folder(folder),
                Err(_) => break Self::lock_file(path),
            }
        };
        if let Lock::Folder(file) | Lock::FileInIt(file) = &folder {
            // Children hold the lock too: by default they would close it.
            fcntl_setfd(file, FdFlags::empty()).context("cannot pass the lock on to the stages")?;
        }
        Ok(Self { path: path.to_owned(), made, lock: folder })
    }

    /// Network file systems lock only what is open for writing, which a folder never is.
    fn lock_file(folder: &Path) -> Lock {
        let path = folder.join(LOCK_FILE);
        let locked = || -> io::Result<File> {
            loop {
                let file = File::options().write(true).create(true).truncate(false).open(&path)?;
                lock_or_wait(&file, &path, folder).inspect_err(|_| {
                    // Nobody can hold it.
                    let _ = fs::remove_file(&path);
                })?;
                // Whoever held the lock has removed the file.
                if is_at(&file, &path) {
                    return Ok(file);
                }
            }
        };
        locked().map_or_else(
            |error| {
                say(format_args!(
                    "note: {} cannot be locked ({error}): start no second run into it before this one has ended; \
                     what a killed run left there stays",
                    folder.display()
                ));
                Lock::Nothing
            },
            Lock::FileInIt,
        )
    }

    /// Its path.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Whether nobody else writes here for sure.
    pub(crate) fn is_locked(&self) -> bool {
        !matches!(self.lock, Lock::Nothing)
    }
}

impl Drop for LockedFolder {
    fn drop(&mut self) {
        if let Lock::FileInIt(_) = self.lock {
            let _ = fs::remove_file(self.path.join(LOCK_FILE));
        }
        // Nothing was written: the folders that were made for it go too. One that holds something stays.
        for folder in &self.made {
            if fs::remove_dir(folder).is_err() {
                break;
            }
        }
        // Also for children that a stage may have left running.
        if let Lock::Folder(file) | Lock::FileInIt(file) = &self.lock {
            let _ = file.unlock();
        }
    }
}

/// The folder, made where there is none.
fn made_and_opened(path: &Path) -> anyhow::Result<File> {
    let mut tries = 0;
    loop {
        tries += 1;
        // Found there by one call and gone for the next, it is said to exist; what is no folder stays in the way.
        let is_gone = |error: &io::Error| match error.kind() {
            io::ErrorKind::NotFound => tries < TRIES,
            io::ErrorKind::AlreadyExists => tries < TRIES && (path.is_dir() || !path.exists()),
            _ => false,
        };
        match fs::create_dir_all(path) {
            Err(error) if is_gone(&error) => continue,
            Err(error) => {
                return Err(Usage::new(format!("cannot make the run folder {}: {error}", path.display()))
                    .hint("say where to: just out=DIR run RECORD")
                    .into());
            }
            Ok(()) => {}
        }
        match File::open(path) {
            Err(error) if is_gone(&error) => {}
            opened => return opened.with_context(|| format!("cannot open the run folder {}", path.display())),
        }
    }
}

/// Locks an open file or folder; an error where its file system cannot.
fn lock_or_wait(file: &File, path: &Path, folder: &Path) -> io::Result<()> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => {
            say(format_args!(
                "waiting for {} in {} (another folder does not wait: just out=DIR run RECORD)",
                holder_of(path),
                folder.display()
            ));
            file.lock()
        }
        Err(TryLockError::Error(error)) => Err(error),
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
    fn a_lock_file_holds_others_back_and_goes_with_the_lock() {
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join(LOCK_FILE);
        let locked = |lock| LockedFolder { path: root.path().to_owned(), made: Vec::new(), lock };
        let first = locked(LockedFolder::lock_file(root.path()));
        assert!(first.is_locked());
        assert!(matches!(File::open(&file).unwrap().try_lock(), Err(TryLockError::WouldBlock)));
        std::thread::scope(|scope| {
            let second = scope.spawn(|| locked(LockedFolder::lock_file(root.path())));
            std::thread::sleep(std::time::Duration::from_millis(100));
            assert!(!second.is_finished());
            drop(first);
            let second = second.join().unwrap();
            assert!(second.is_locked() && file.exists());
        });
        assert!(!file.exists());
        assert!(!locked(LockedFolder::lock_file(&root.path().join("none"))).is_locked());
    }

    #[test]
    fn runs_that_remove_and_make_the_same_folder_do_not_fail() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a/b");
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| (0..50).for_each(|_| drop(LockedFolder::lock(&path).unwrap())));
            }
        });
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

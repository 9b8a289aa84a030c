//! One run at a time in a folder: the lock, and who holds it.

use std::ffi::OsString;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use crate::command::{Options, elsewhere, named};
use anyhow::Context;
use crumple_stage::{Call, Usage, Way, say};
use same_file::Handle;

/// Stands in the run folder while a run works there, where the file system does not lock folders.
const LOCK_FILE: &str = ".crumple-run.lock";

/// How often a folder may go between being made and being opened: another run that failed removes what it made.
const TRIES: u32 = 100;

/// A run folder that no other run works in.
///
/// The folder itself is locked, so no file stays behind; where the file system refuses that, a file in it. The programs
/// started here inherit the lock: where this process is killed, the folder is free once the stage that it started has
/// ended too. Windows locks no folders and passes no lock on: there a file is locked, and killing a run leaves the
/// folder free at once.
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
    /// Makes the folder where there is none, and waits while another run works in it, saying for whom unless `quiet`.
    pub(crate) fn lock(path: &Path, quiet: bool) -> anyhow::Result<Self> {
        let made = path.ancestors().take_while(|p| !p.exists()).map(Path::to_owned).collect();
        let folder = loop {
            let folder = made_and_opened(path)?;
            match lock_or_wait(&folder, path, path, quiet) {
                // Whoever held the lock may have removed the folder, and a third made it again.
                Ok(()) if !is_at(&folder, path) => {}
                Ok(()) => break Lock::Folder(folder),
                Err(_) => break Self::lock_file(path, quiet),
            }
        };
        if let Lock::Folder(file) | Lock::FileInIt(file) = &folder {
            // Children hold the lock too: by default they would close it.
            pass_on(file).context("cannot pass the lock on to the stages")?;
        }
        Ok(Self { path: path.to_owned(), made, lock: folder })
    }

    /// Network file systems lock only what is open for writing, which a folder never is.
    fn lock_file(folder: &Path, quiet: bool) -> Lock {
        let path = folder.join(LOCK_FILE);
        let locked = || -> io::Result<File> {
            loop {
                let file = File::options().write(true).create(true).truncate(false).open(&path)?;
                lock_or_wait(&file, &path, folder, quiet).inspect_err(|_| {
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
                    .hint(format!("say where to: {}", elsewhere()))
                    .into());
            }
            Ok(()) => {}
        }
        match open_folder(path) {
            Err(error) if is_gone(&error) => {}
            opened => return opened.with_context(|| format!("cannot open the run folder {}", path.display())),
        }
    }
}

fn open_folder(path: &Path) -> io::Result<File> {
    let mut options = File::options();
    // FILE_FLAG_BACKUP_SEMANTICS: without it Windows opens no folder.
    #[cfg(windows)]
    std::os::windows::fs::OpenOptionsExt::custom_flags(&mut options, 0x0200_0000);
    options.read(true).open(path)
}

/// Locks an open file or folder; an error where its file system cannot.
fn lock_or_wait(file: &File, path: &Path, folder: &Path, quiet: bool) -> io::Result<()> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => {
            if !quiet {
                say(format_args!(
                    "waiting for {} in {} (another folder does not wait: {})",
                    holder_of(path),
                    folder.display(),
                    elsewhere()
                ));
            }
            file.lock()
        }
        Err(TryLockError::Error(error)) => Err(error),
    }
}

/// Lets children hold the lock of a file.
#[cfg(unix)]
fn pass_on(file: &File) -> io::Result<()> {
    Ok(rustix::io::fcntl_setfd(file, rustix::io::FdFlags::empty())?)
}

/// Lets children hold the lock of a file: only on Unix.
#[cfg(not(unix))]
fn pass_on(_: &File) -> io::Result<()> {
    Ok(())
}

/// Whether a path still leads to an open file.
pub(crate) fn is_at(file: &File, path: &Path) -> bool {
    let open = file.try_clone().and_then(Handle::from_file);
    matches!((open, Handle::from_path(path)), (Ok(open), Ok(there)) if open == there)
}

/// A process and the words of its command line.
type Holder = (u32, Vec<OsString>);

/// The process that holds a lock, as far as `/proc` tells: where it does not, "another process".
fn holder_of(locked: &Path) -> String {
    let look = || holders(locked).unwrap_or_default();
    in_words(&look(), || {
        // A run that just takes or leaves the lock, or starts a stage, shows itself at a second look.
        sleep(Duration::from_millis(50));
        look()
    })
}

/// A stage without its run is left over only if two looks say so.
fn in_words(holders: &[Holder], look_again: impl FnOnce() -> Vec<Holder>) -> String {
    let run = |holders: &[Holder]| {
        holders.iter().find_map(|(id, words)| {
            let record = record_of(words)?;
            Some(format!("process {id}, which runs {}", record.to_string_lossy()))
        })
    };
    if let Some(run) = run(holders) {
        return run;
    }
    let again = look_again();
    if let Some(run) = run(&again) {
        return run;
    }
    let of_a_run = |holders: &[Holder]| holders.iter().any(|(_, words)| words_of_a_run(words).is_some());
    let stage = again.iter().filter(|holder| holders.contains(holder)).find_map(|(id, words)| {
        let name = Path::new(words.first()?).file_name()?.to_string_lossy();
        Some(format!("process {id} ({name}), left over from a run that was killed"))
    });
    stage.filter(|_| !of_a_run(holders) && !of_a_run(&again)).unwrap_or_else(|| "another process".to_owned())
}

/// The words behind `crumple-run` or `crumple run`.
fn words_of_a_run(words: &[OsString]) -> Option<&[OsString]> {
    let is_program = |name: &str| Path::new(words.first()?).file_name().filter(|file| *file == name);
    let of_one_program = || words.get(2..).filter(|_| is_program("crumple").is_some() && words[1] == "run");
    is_program("crumple-run").map(|_| &words[1..]).or_else(of_one_program)
}

/// The record of a run.
fn record_of(words: &[OsString]) -> Option<OsString> {
    let words = words_of_a_run(words)?.iter().filter(|word| !word.is_empty()).cloned().collect();
    let call = Call { program: String::new(), words, way: Way::Alone };
    named::<Options>(&call, Some(&(crumple_ingest::PROGRAM.command)()))
}

/// Every process that holds the lock.
fn holders(locked: &Path) -> io::Result<Vec<Holder>> {
    let locked = locked.canonicalize()?;
    let mut holders = Vec::new();
    for process in fs::read_dir("/proc")?.flatten() {
        let Some(id) = process.file_name().to_str().and_then(|name| name.parse().ok()) else { continue };
        let Ok(open) = fs::read_dir(process.path().join("fd")) else { continue };
        let holds = open.flatten().any(|fd| {
            let lock = || fs::read_to_string(process.path().join("fdinfo").join(fd.file_name()));
            fs::read_link(fd.path()).is_ok_and(|target| target == locked)
                && lock().is_ok_and(|info| info.lines().any(|line| line.starts_with("lock:")))
        });
        if holds {
            let line = fs::read(process.path().join("cmdline")).unwrap_or_default();
            let words = line.split(|byte| *byte == 0).map(|word| String::from_utf8_lossy(word).into_owned().into());
            holders.push((id, words.collect()));
        }
    }
    Ok(holders)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_leaves_no_trace_and_keeps_what_was_there() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a/b");
        drop(LockedFolder::lock(&path, true).unwrap());
        assert!(!root.path().join("a").exists());
        {
            let locked = LockedFolder::lock(&path, true).unwrap();
            assert!(matches!(File::open(&path).unwrap().try_lock(), Err(TryLockError::WouldBlock)));
            fs::write(locked.path().join("result"), "x").unwrap();
        }
        assert!(File::open(&path).unwrap().try_lock().is_ok());
        drop(LockedFolder::lock(&path, true).unwrap());
        assert!(path.join("result").exists());
    }

    #[test]
    fn a_lock_file_holds_others_back_and_goes_with_the_lock() {
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join(LOCK_FILE);
        let locked = |lock| LockedFolder { path: root.path().to_owned(), made: Vec::new(), lock };
        let first = locked(LockedFolder::lock_file(root.path(), true));
        assert!(first.is_locked());
        assert!(matches!(File::open(&file).unwrap().try_lock(), Err(TryLockError::WouldBlock)));
        std::thread::scope(|scope| {
            let second = scope.spawn(|| locked(LockedFolder::lock_file(root.path(), true)));
            sleep(Duration::from_millis(100));
            assert!(!second.is_finished());
            drop(first);
            let second = second.join().unwrap();
            assert!(second.is_locked() && file.exists());
        });
        assert!(!file.exists());
        assert!(!locked(LockedFolder::lock_file(&root.path().join("none"), true)).is_locked());
    }

    #[test]
    fn runs_that_remove_and_make_the_same_folder_do_not_fail() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a/b");
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| (0..50).for_each(|_| drop(LockedFolder::lock(&path, true).unwrap())));
            }
        });
    }

    #[test]
    fn a_run_folder_that_is_a_file_is_refused() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("file");
        fs::write(&path, "x").unwrap();
        let error = LockedFolder::lock(&path, true).unwrap_err();
        assert!(error.to_string().starts_with("cannot make the run folder"), "{error}");
    }

    #[test]
    fn only_what_two_looks_see_is_left_over() {
        let holder = |id, line: &str| vec![(id, line.split(' ').map(OsString::from).collect())];
        let stage = holder(7, "/bin/crumple-identify x");
        let run = holder(6, "/bin/crumple-run -- crash.csv");
        let words = |first: &[Holder], second: &[Holder]| in_words(first, || second.to_vec());
        assert_eq!(words(&run, &[]), "process 6, which runs crash.csv");
        let of_one_program = holder(5, "/bin/crumple run --mass 9kg crash.csv");
        assert_eq!(words(&of_one_program, &[]), "process 5, which runs crash.csv");
        assert_eq!(words(&stage, &run), "process 6, which runs crash.csv");
        assert_eq!(words(&stage, &stage), "process 7 (crumple-identify), left over from a run that was killed");
        for unclear in [vec![], holder(7, ""), holder(8, "/bin/sh")] {
            assert_eq!(words(&stage, &unclear), "another process");
            assert_eq!(words(&unclear, &stage), "another process");
        }
        assert_eq!(words(&holder(7, ""), &holder(7, "")), "another process");
    }
}

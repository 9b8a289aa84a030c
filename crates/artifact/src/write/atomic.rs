//! Files that appear whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::TempPath;

use super::output_kind::OutputKind;

/// Writes `path` through a temporary file beside it: on success the target is replaced in one step, on failure it is
/// left as it was and the temporary file is removed. A killed process leaves at most a `*.tmp` file, never half a
/// target.
///
/// Missing parent folders are made. A target that exists and is of another kind is left alone: an error.
pub fn write_atomically<T, E: From<io::Error>>(
    path: &Path,
    kind: OutputKind,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<T, E>,
) -> Result<T, E> {
    replace_atomically(path, kind, &[], write)
}

/// [`write_atomically`] that removes files made from the old target, in order, right before the new one appears: a
/// process killed at any moment leaves none of them beside a target they were not made from. A failure before that
/// leaves them all.
pub fn replace_atomically<T, E: From<io::Error>>(
    path: &Path,
    kind: OutputKind,
    dependents: &[PathBuf],
    write: impl FnOnce(&mut BufWriter<File>) -> Result<T, E>,
) -> Result<T, E> {
    replace_by(&Steps::OF_THE_DISK, path, kind, dependents, write)
}

/// The steps that can fail after everything is written; tests make each of them fail.
struct Steps {
    flush: fn(&mut BufWriter<File>) -> io::Result<()>,
    sync: fn(&File) -> io::Result<()>,
    rename: fn(TempPath, &Path) -> io::Result<()>,
}

impl Steps {
    const OF_THE_DISK: Self = Self {
        flush: |writer| writer.flush(),
        sync: File::sync_data,
        rename: |from, to| from.persist(to).map_err(|error| error.error),
    };
}

fn replace_by<T, E: From<io::Error>>(
    steps: &Steps,
    path: &Path,
    kind: OutputKind,
    dependents: &[PathBuf],
    write: impl FnOnce(&mut BufWriter<File>) -> Result<T, E>,
) -> Result<T, E> {
    if let Some(problem) = kind.problem_at(path)? {
        return Err(io::Error::new(io::ErrorKind::AlreadyExists, problem).into());
    }
    // A link stays a link: what it points at is replaced.
    let target = fs::canonicalize(path);
    let path = target.as_deref().unwrap_or(path);
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    fs::create_dir_all(folder)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let temporary =
        readable(tempfile::Builder::new().prefix(&format!(".{name}.")).suffix(".tmp")).tempfile_in(folder)?;
    let (file, temporary_path) = temporary.into_parts();
    let mut writer = BufWriter::with_capacity(1 << 17, file);
    let value = write(&mut writer)?;
    (steps.flush)(&mut writer)?;
    let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
    // To the disk before the rename: after a power cut the name must not point at an empty file.
    (steps.sync)(&file)?;
    remove_in_order(dependents)?;
    (steps.rename)(temporary_path, path)?;
    Ok(value)
}

/// Removes files one after another; those that do not exist are passed over.
pub fn remove_in_order(paths: &[PathBuf]) -> io::Result<()> {
    for path in paths {
        match fs::remove_file(path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    Ok(())
}

/// Temporary files are private to the user; a result is readable like any other file, as far as the umask allows.
#[cfg(unix)]
pub fn readable<'a, 'b, 'c>(builder: &'c mut tempfile::Builder<'a, 'b>) -> &'c mut tempfile::Builder<'a, 'b> {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(fs::Permissions::from_mode(0o666))
}

/// Temporary files are private to the user; a result is readable like any other file, as far as the umask allows.
#[cfg(not(unix))]
pub fn readable<'a, 'b, 'c>(builder: &'c mut tempfile::Builder<'a, 'b>) -> &'c mut tempfile::Builder<'a, 'b> {
    builder
}

#[cfg(test)]
mod tests {
    use super::*;

    const KIND: OutputKind = OutputKind::Artifact;
    const OLD: &[u8] = b"\x89MCAP old, crumple.Notes.v1";

    /// A folder with an artifact, and the names in it.
    fn with_an_old_artifact() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.mcap");
        write_atomically(&path, KIND, |w| w.write_all(OLD)).unwrap();
        (folder, path)
    }

    /// Write, flush, sync and rename fail in turn, of a new file and of one that replaces another.
    #[test]
    fn a_step_that_fails_leaves_the_old_file_and_nothing_else() {
        let disk_is_full = || io::Error::new(io::ErrorKind::StorageFull, "the disk is full");
        let flush = Steps { flush: |_| Err(io::ErrorKind::StorageFull.into()), ..Steps::OF_THE_DISK };
        let sync = Steps { sync: |_| Err(io::ErrorKind::StorageFull.into()), ..Steps::OF_THE_DISK };
        let rename = Steps { rename: |_, _| Err(io::ErrorKind::StorageFull.into()), ..Steps::OF_THE_DISK };
        for (steps, write_fails) in [(Steps::OF_THE_DISK, true), (flush, false), (sync, false), (rename, false)] {
            let (folder, path) = with_an_old_artifact();
            for path in [path.clone(), folder.path().join("new.mcap")] {
                let failed = replace_by(&steps, &path, KIND, &[], |w| {
                    w.write_all(b"half of the n")?;
                    if write_fails { Err(disk_is_full()) } else { Ok(()) }
                });
                assert_eq!(failed.unwrap_err().kind(), io::ErrorKind::StorageFull);
            }
            assert_eq!(fs::read(&path).unwrap(), OLD);
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        }
    }

    #[test]
    fn a_file_of_another_kind_is_never_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("crash.csv");
        fs::write(&path, "time_s,accel_g\n").unwrap();
        for kind in [KIND, OutputKind::Report, OutputKind::Summary, OutputKind::Lines] {
            let failed = write_atomically(&path, kind, |w| w.write_all(b"new"));
            assert_eq!(failed.unwrap_err().kind(), io::ErrorKind::AlreadyExists);
        }
        assert_eq!(fs::read(&path).unwrap(), b"time_s,accel_g\n");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn dependents_go_before_the_new_file_appears_and_stay_where_it_does_not() {
        let (folder, path) = with_an_old_artifact();
        let report = folder.path().join("report.html");
        let dependents = [report.clone(), folder.path().join("never-made.mcap")];
        fs::write(&report, b"of the old").unwrap();
        let failed = replace_atomically(&path, KIND, &dependents, |_| Err::<(), _>(io::Error::other("killed")));
        assert!(failed.is_err() && report.exists());
        replace_atomically(&path, KIND, &dependents, |w| w.write_all(b"new")).unwrap();
        assert!(!report.exists());
        assert_eq!(fs::read(&path).unwrap(), b"new");
    }

    #[test]
    fn only_what_is_missing_is_passed_over_where_files_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a");
        fs::write(&file, b"x").unwrap();
        remove_in_order(&[folder.path().join("missing"), file.clone()]).unwrap();
        assert!(!file.exists());
        assert!(remove_in_order(&[folder.path().to_owned()]).is_err(), "a folder is no file");
    }

    /// A result is readable like any other file, not private to the user as temporary files are.
    #[cfg(unix)]
    #[test]
    fn a_result_has_the_permissions_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let (folder, path) = with_an_old_artifact();
        let other = folder.path().join("other");
        fs::write(&other, b"x").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&other));
    }
}

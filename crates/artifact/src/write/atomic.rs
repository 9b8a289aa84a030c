//! Files that appear whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes `path` through a temporary file beside it: on success the target is replaced in one step, on failure it is
/// left as it was and the temporary file is removed. A killed process leaves at most a `*.tmp` file, never half a
/// target.
///
/// Missing parent folders are made.
pub fn write_atomically<T, E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<T, E>,
) -> Result<T, E> {
    replace_atomically(path, &[], write)
}

/// [`write_atomically`] that removes files made from the old target, in order, right before the new one appears: a
/// process killed at any moment leaves none of them beside a target they were not made from. A failure before that
/// leaves them all.
pub fn replace_atomically<T, E: From<io::Error>>(
    path: &Path,
    dependents: &[PathBuf],
    write: impl FnOnce(&mut BufWriter<File>) -> Result<T, E>,
) -> Result<T, E> {
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
    writer.flush()?;
    let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
    // To the disk before the rename: after a power cut the name must not point at an empty file.
    file.sync_data()?;
    remove_in_order(dependents)?;
    temporary_path.persist(path).map_err(|error| error.error)?;
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
fn readable<'a, 'b, 'c>(builder: &'c mut tempfile::Builder<'a, 'b>) -> &'c mut tempfile::Builder<'a, 'b> {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(fs::Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn readable<'a, 'b, 'c>(builder: &'c mut tempfile::Builder<'a, 'b>) -> &'c mut tempfile::Builder<'a, 'b> {
    builder
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.mcap");
        write_atomically(&path, |w| w.write_all(b"old")).unwrap();
        let failed = write_atomically(&path, |w| {
            w.write_all(b"half of the n")?;
            Err::<(), _>(io::Error::other("killed"))
        });
        assert!(failed.is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn dependents_go_before_the_new_file_appears_and_stay_where_it_does_not() {
        let folder = tempfile::tempdir().unwrap();
        let (path, report) = (folder.path().join("x.mcap"), folder.path().join("report.html"));
        let dependents = [report.clone(), folder.path().join("never-made.mcap")];
        fs::write(&path, b"old").unwrap();
        fs::write(&report, b"of the old").unwrap();
        let failed = replace_atomically(&path, &dependents, |_| Err::<(), _>(io::Error::other("killed")));
        assert!(failed.is_err() && report.exists());
        replace_atomically(&path, &dependents, |w| w.write_all(b"new")).unwrap();
        assert!(!report.exists());
        assert_eq!(fs::read(&path).unwrap(), b"new");
    }
}

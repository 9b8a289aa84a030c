//! Pipes with a name in a folder: to open one waits until somebody writes to it, for ever perhaps.

use std::fs::FileType;
use std::io;
use std::path::Path;

/// Refuses a pipe or socket that lies in a folder; a pipe of the shell (`<(zcat x.gz)`) has its writer and passes.
///
/// # Errors
/// The path is such a pipe.
pub fn refuse_named_pipe(path: &Path) -> io::Result<()> {
    let Ok(metadata) = std::fs::metadata(path) else { return Ok(()) };
    // What the shell made has no place in the file system.
    if is_pipe(metadata.file_type()) && path.canonicalize().is_ok() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a pipe, not a file"));
    }
    Ok(())
}

/// Whether it is a pipe or a socket. Elsewhere than on Unix these do not lie in folders.
#[cfg(unix)]
fn is_pipe(kind: FileType) -> bool {
    use std::os::unix::fs::FileTypeExt;
    kind.is_fifo() || kind.is_socket()
}

/// Whether it is a pipe or a socket. Elsewhere than on Unix these do not lie in folders.
#[cfg(not(unix))]
fn is_pipe(_: FileType) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Artifact;

    #[test]
    fn a_pipe_without_a_writer_is_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("1-ingest.mcap");
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        assert!(refuse_named_pipe(&path).is_err() && refuse_named_pipe(folder.path()).is_ok());
        let error = Artifact::open(&path).unwrap_err().to_string();
        assert!(error.ends_with("it is a pipe, not a file"), "{error}");
        assert!(refuse_named_pipe(&folder.path().join("none")).is_ok());
    }
}

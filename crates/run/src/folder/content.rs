//! What stands at a path of the run folder.

use std::fs::File;
use std::io::Read;
use std::path::Path;

/// What a file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Content {
    /// There is no such file, or it is empty.
    Nothing,
    /// It begins as an artifact does.
    Artifact,
    /// Anything else.
    Other,
}

/// What the file at a path holds, by its first bytes.
pub(crate) fn content_of(path: &Path) -> Content {
    let mut start = Vec::new();
    match File::open(path).and_then(|file| file.take(5).read_to_end(&mut start)) {
        Err(_) | Ok(0) => Content::Nothing,
        Ok(_) if start == b"\x89MCAP" => Content::Artifact,
        Ok(_) => Content::Other,
    }
}

/// Whether an output of this name is an artifact.
pub(crate) fn is_artifact(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|ending| ending == "mcap")
}

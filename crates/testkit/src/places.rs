//! Where the workspace and the shared reference material lie.

use std::path::PathBuf;

// The folders that tests read from.

/// A file or folder of the shared reference material, if it is here.
///
/// Looks in `CRUMPLE_SHARED`, else beside the workspace. Where it is absent, prints that the test is skipped:
/// the caller returns.
pub fn shared(path: &str) -> Option<PathBuf> {
    let root = std::env::var_os("CRUMPLE_SHARED")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared")), PathBuf::from);
    let shared = root.join(path);
    if shared.exists() {
        return Some(shared);
    }
    eprintln!("SKIPPED: {} is not here (set CRUMPLE_SHARED)", shared.display());
    None
}

/// The workspace root.
pub fn workspace() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

//! Helpers for the workspace's tests, and the fixture generator. A dev-dependency only.

pub mod fixture;
pub mod pipeline;
pub mod program;
pub mod reference_signals;
pub mod stopwatch;

use std::path::PathBuf;

/// A file or folder of the shared reference material, if it is here.
///
/// Looks in `CRUMPLE_SHARED`, else beside the workspace. Where it is absent, prints that the test is skipped:
/// the caller returns.
pub fn shared(path: &str) -> Option<PathBuf> {
    let root = std::env::var_os("CRUMPLE_SHARED")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared")), PathBuf::from);
    let found = root.join(path);
    if found.exists() {
        return Some(found);
    }
    eprintln!("SKIPPED: {} is not here (set CRUMPLE_SHARED)", found.display());
    None
}

/// The workspace root.
pub fn workspace() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// `truth.json` of a record with known parameters, if it is here.
///
/// Looks in the folder `CRUMPLE_KNOWN_TRUTH`, else among the shared reference material; prints the skip line
/// where it is absent. A file that is there and cannot be read is the test's failure, not a skip.
pub fn known_truth(record: &str) -> Option<serde_json::Value> {
    let folder = match std::env::var_os("CRUMPLE_KNOWN_TRUTH") {
        Some(folder) => PathBuf::from(folder).join(record),
        None => shared(&format!("reference/known-truth/{record}"))?,
    };
    let path = folder.join("truth.json");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    Some(serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display())))
}

//! Helpers for the workspace's tests, and the fixture generator. A dev-dependency only.

pub mod bytes;
mod filtered;
pub mod fixture;
mod integrated;
mod known_truth;
pub mod pipeline;
pub mod program;
pub mod reference_signals;
pub mod stopwatch;
mod table_5;
mod white_noise;

use std::path::PathBuf;

pub use filtered::write_filtered;
pub use integrated::{IMPACT_SPEED_M_PER_S, integrated};
pub use known_truth::{KnownTruth, known_truths, known_truths_in, other_records, write_known_truth};
pub use table_5::table_5;
pub use white_noise::{uniform, white_noise};

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

/// `truth.json` of the record of this name, for tests that need one and no other; [`known_truths`] goes over all.
///
/// Looks in the folder `CRUMPLE_KNOWN_TRUTH`, else among the shared reference material; prints the skip line
/// where the record is absent. A file that is there and cannot be read is the test's failure, not a skip.
pub fn known_truth(record: &str) -> Option<serde_json::Value> {
    let found = known_truths().into_iter().find(|known| known.name == record);
    if found.is_none() {
        eprintln!("SKIPPED: no record {record} among those with known parameters");
    }
    found.map(|known| known.truth)
}

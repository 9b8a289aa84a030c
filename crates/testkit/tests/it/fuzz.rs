//! A short campaign of files as attackers make them; `just fuzz` runs long ones.

use crumple_testkit::fuzz::{Campaign, run_campaign};
use crumple_testkit::pipeline;

#[test]
fn programs_end_as_they_may_on_mutated_files_and_tampered_artifacts() {
    let folder = tempfile::tempdir().unwrap();
    let bin = pipeline::binary("crumple-ingest").parent().unwrap().to_owned();
    let campaign = Campaign { bin, folder: folder.path().to_owned(), first: 0, files: 60 };
    let mut told = Vec::new();
    let tallies = run_campaign(&campaign, &mut |line| told.push(line)).unwrap();
    assert!(told.is_empty(), "{}", told.join("\n"));
    // Both ways out are taken, or nothing was tried.
    for tally in tallies {
        assert!(tally.0.len() >= 2, "{tally}");
    }
}

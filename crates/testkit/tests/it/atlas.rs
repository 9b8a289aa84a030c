//! The committed atlas: what its page counts, and pulses run again.

use crumple_testkit::atlas::{Atlas, Found, found_of_pulses, misses_without_reason, page};
use crumple_testkit::programs::binary;
use crumple_testkit::workspace;

fn committed() -> (Atlas, Vec<Found>) {
    let found = std::fs::read(workspace().join("ci/atlas.json")).unwrap();
    (Atlas::read().unwrap(), serde_json::from_slice(&found).unwrap())
}

#[test]
fn the_page_is_that_of_what_was_found_and_hides_no_miss() {
    let (atlas, found) = committed();
    let text = std::fs::read_to_string(workspace().join("docs/atlas.md")).unwrap();
    assert_eq!(text, page(&atlas, &found), "`just atlas` writes docs/atlas.md");
    // A row has short cells: a screen of a laptop shows so many characters.
    let long: Vec<&str> = text.lines().filter(|line| line.chars().count() > 160).collect();
    assert_eq!(long, Vec::<&str>::new());
    assert!(found.len() >= 30, "{} rows run", found.len());
    assert_eq!(misses_without_reason(&found), Vec::<&Found>::new());
    // Every figure is run, or says why it is not; none does both.
    for figure in &atlas.figures {
        let is_run = found.iter().any(|one| one.figure == figure.id);
        assert_ne!(is_run, figure.not_run.is_some(), "{}", figure.id);
    }
    let rows = |mark: &str| text.matches(mark).count();
    let misses = found.iter().filter(|one| !one.hit).count();
    assert_eq!(rows(" **miss** |"), misses, "misses shown");
    assert_eq!(rows("| hit |") + rows(" ✓ |"), found.len() - misses, "hits shown");
}

#[test]
fn pulses_of_regulations_come_out_as_they_are_committed() {
    let (atlas, committed) = committed();
    let folder = tempfile::tempdir().unwrap();
    let bin = binary("crumple");
    let again = found_of_pulses(&atlas.pulses, bin.parent().unwrap(), folder.path()).unwrap();
    assert!(again.len() > 30, "{}", again.len());
    for one in &again {
        let before = committed.iter().find(|other| (&other.figure, &other.of) == (&one.figure, &one.of)).unwrap();
        // Rounding of another processor.
        assert!((one.value / before.value - 1.0).abs() < 1e-9 && one.hit == before.hit, "{one:?} {before:?}");
    }
}

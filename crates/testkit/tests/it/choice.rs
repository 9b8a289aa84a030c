//! The model that a record was made of is recommended or the simplest, or one that the record does not tell from it:
//! a few records of families that a rule of the choice once lost (`just interval-benchmark --choice` counts hundreds).

use crumple_testkit::interval_cover::{Choices, DRAWN, choices_of};
use crumple_testkit::pipeline::binary;
use crumple_testkit::workspace;

/// At least eight of ten: nine in ten are the aim of hundreds.
#[test]
fn the_model_of_a_record_is_chosen() {
    let bin = binary("crumple-ingest");
    let pipeline = workspace().join("pipelines/default.toml");
    let folder = tempfile::tempdir().unwrap();
    // Records whose misfit is mostly zero level; a knot that the record leaves open; the same and fewer samples; fits
    // to the displacement that end on bounds.
    for name in ["elastoplastic", "nonlinear-1", "nonlinear-2", "triple"] {
        let drawn = DRAWN.iter().find(|drawn| drawn.name == name).unwrap();
        let choices = choices_of(drawn, 3010..3020, false, (bin.parent().unwrap(), &pipeline), folder.path()).unwrap();
        assert!(choices.held_percent() >= 80.0, "{}\n{}", Choices::HEAD, choices.row(name));
    }
}

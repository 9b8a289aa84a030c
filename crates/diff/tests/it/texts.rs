//! The program: values and texts of records, and what differs for information.

use crumple_artifact::records::{SourceV1, TestV1};
use crumple_artifact::{ArtifactBuilder, Compression, Provenance};
use crumple_signal::TestDescription;

use crate::program::{Made, diff, pair};

#[test]
fn values_of_records_and_texts_are_named() {
    let b = Made { olc: 256.5, notes: vec!["zero level 0.02 m/s^2".into(), "more".into()], ..Made::default() };
    let folder = pair(&b);
    let output = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(output.code, 1);
    insta::assert_snapshot!(output.stdout, @r#"
    /metrics, [olc].value: 255.0  256.5  (abs 1.5, rel 0.005848)
    /notes, notes length: 1  2
    /notes, notes[0]: "zero level 0.01 m/s^2"  "zero level 0.02 m/s^2"  (for information)
    different: 2 of 3 topics
    "#);
    // 1.5 of 256.5 is 0.58 %: beyond what an engineer calls the same; the texts differ anyway.
    let output = diff(folder.path(), &["a.mcap", "b.mcap", "--engineering"]);
    assert!(output.stdout.contains("/metrics, [olc].value"), "{}", output.stdout);
}

#[test]
fn notes_with_other_numbers_are_told_and_are_no_result() {
    let folder = pair(&Made { notes: vec!["zero level 0.02 m/s^2".into()], ..Made::default() });
    let output = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(output.code, 0, "{}{}", output.stdout, output.stderr);
    insta::assert_snapshot!(output.stdout, @r#"
    /notes, notes[0]: "zero level 0.01 m/s^2"  "zero level 0.02 m/s^2"  (for information)
    same within tolerance: 228 values in 3 topics, none differs; one text differs and does not count
    "#);
    let json = diff(folder.path(), &["a.mcap", "b.mcap", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!(json["files"][0]["topics"][1]["aside"][0]["place"], "notes[0]");
    assert_eq!(diff(folder.path(), &["a.mcap", "b.mcap", "--exact"]).code, 1);
    // Other words are a difference.
    let folder = pair(&Made { notes: vec!["no zero level 0.01 m/s^2".into()], ..Made::default() });
    assert_eq!(diff(folder.path(), &["a.mcap", "b.mcap"]).code, 1);
}

#[test]
fn the_digest_of_the_file_that_a_record_came_in_counts_as_provenance() {
    let folder = tempfile::tempdir().unwrap();
    for (name, digest) in [("a.mcap", "blake3:00"), ("b.mcap", "blake3:11")] {
        let source = SourceV1 { format: "csv".into(), name: name.into(), digest: digest.into() };
        let test = TestV1 { source, ..TestV1::from(&TestDescription::default()) };
        let mut builder = ArtifactBuilder::new();
        builder.put("/test", &test).unwrap();
        let provenance = Provenance::new("ingest", "0.1.0", "{}".into(), Vec::new());
        builder.write(&folder.path().join(name), &provenance, Compression::None).unwrap();
    }
    let output = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(output.code, 0, "{}{}", output.stdout, output.stderr);
    assert!(
        output.stdout.contains("/test, source.digest: \"blake3:00\"  \"blake3:11\"  (for information)"),
        "{}",
        output.stdout
    );
    assert_eq!(diff(folder.path(), &["a.mcap", "b.mcap", "--provenance"]).code, 1);
}

#[test]
fn only_a_few_differences_of_a_topic_are_shown_unless_all_are_asked_for() {
    let notes = |word: &str| (0..9).map(|k| format!("{word} {k}")).collect::<Vec<_>>();
    let folder = tempfile::tempdir().unwrap();
    Made { notes: notes("a"), ..Made::default() }.write(&folder.path().join("a.mcap"));
    Made { notes: notes("b"), ..Made::default() }.write(&folder.path().join("b.mcap"));
    let few = diff(folder.path(), &["a.mcap", "b.mcap"]).stdout;
    assert!(few.contains("/notes: 4 more (--all shows them)"), "{few}");
    assert!(!few.contains("notes[8]"), "{few}");
    assert!(diff(folder.path(), &["a.mcap", "b.mcap", "--all"]).stdout.contains("notes[8]"));
}

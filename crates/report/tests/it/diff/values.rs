//! What a difference says: its place, both values, how far they are apart, and what that distance refers to.

use std::io::Cursor;
use std::path::Path;

use crumple_artifact::records::{NotesV1, SourceV1, TestV1};
use crumple_artifact::{Artifact, ArtifactBuilder, Compression, Provenance};
use crumple_diff::{Base, CompareSettings, Difference, Tolerances, compare_artifacts, compare_json};
use crumple_signal::{QuantityKind, Sampled, TestDescription};
use serde_json::{Value, json};

use super::{Made, diff, pair};

fn engineering() -> CompareSettings {
    let tolerances = Tolerances { base: Base::Engineering, ..Tolerances::default() };
    CompareSettings { tolerances, ..CompareSettings::default() }
}

fn differences(a: &Value, b: &Value, settings: &CompareSettings) -> Vec<String> {
    let report = compare_json("/x", a, b, settings);
    assert_eq!(report.same, report.differences.is_empty());
    report.differences.into_iter().map(|difference| difference.place).collect()
}

fn artifact(fill: impl FnOnce(&mut ArtifactBuilder)) -> Artifact {
    let mut builder = ArtifactBuilder::new();
    fill(&mut builder);
    let mut file = Cursor::new(Vec::new());
    let provenance = Provenance::new("filter", "0.1.0", "{}".into(), Vec::new());
    builder.write_to(&mut file, &provenance, Compression::None).unwrap();
    Artifact::read(Path::new("x.mcap"), file.get_ref().as_slice()).unwrap()
}

/// The only difference of two artifacts.
fn only(a: &Artifact, b: &Artifact) -> Difference {
    let report = compare_artifacts("x.mcap", a, b, &CompareSettings::default()).unwrap();
    let mut all: Vec<Difference> = report.topics.into_iter().flat_map(|topic| topic.differences).collect();
    assert_eq!(all.len(), 1, "{all:?}");
    all.remove(0)
}

fn wave(t0_s: f64, dt_s: f64, samples: Vec<f64>) -> Artifact {
    let sampled = Sampled::new(t0_s, dt_s, samples).unwrap();
    artifact(|builder| builder.wave("93", QuantityKind::Velocity, sampled).unwrap())
}

#[test]
fn a_grid_that_differs_says_by_how_much() {
    let samples = vec![1.0, 2.0, 3.0, 4.0];
    let a = wave(0.0, 0.25, samples.clone());
    let interval = only(&a, &wave(0.0, 0.5, samples.clone()));
    assert_eq!((interval.place.as_str(), interval.a, interval.b), ("dt_s", Some(json!(0.25)), Some(json!(0.5))));
    assert_eq!((interval.abs, interval.rel), (Some(0.25), Some(0.5)));
    let start = only(&wave(2.0, 0.25, samples.clone()), &wave(-1.0, 0.25, samples.clone()));
    assert_eq!((start.place.as_str(), start.abs, start.rel), ("t0_s", Some(3.0), Some(1.5)));
    let length = only(&a, &wave(0.0, 0.25, samples[..3].to_vec()));
    assert_eq!((length.place.as_str(), length.abs, length.rel), ("number of samples", Some(1.0), Some(0.25)));
    let other = artifact(|builder| {
        builder.wave("93", QuantityKind::Acceleration, Sampled::new(0.0, 0.25, samples).unwrap()).unwrap();
    });
    let quantity = only(&a, &other);
    assert_eq!((quantity.a, quantity.b), (Some(json!("velocity")), Some(json!("acceleration"))));
    assert_eq!((quantity.abs, quantity.rel), (None, None));
}

#[test]
fn a_topic_of_another_kind_is_named_with_both() {
    let notes = || NotesV1 { stage: "x".into(), notes: Vec::new() };
    let record = artifact(|builder| builder.put("/wave/93", &notes()).unwrap());
    let difference = only(&wave(0.0, 0.25, vec![1.0, 2.0]), &record);
    assert_eq!(difference.place, "type");
    assert_eq!(difference.a, Some(json!("waveform of 2 samples")));
    assert_eq!(difference.b, Some(json!("crumple.Notes.v1")));
}

#[test]
fn energies_are_measured_by_the_largest_of_their_instant() {
    let instant = |rest: f64| json!({"kinetic_j": 1e5, "rest_j": rest, "other": rest});
    assert_eq!(differences(&instant(1e-9), &instant(2e-9), &CompareSettings::default()), ["other"]);
    assert_eq!(differences(&instant(1.0), &instant(2.0), &CompareSettings::default()), ["other", "rest_j"]);
}

#[test]
fn engineering_limits_go_by_the_unit() {
    let metric = |unit: &str, value: f64| json!({"value": value, "unit": unit});
    for (unit, within, beyond) in [("s", 0.9e-4, 1.1e-4), ("m", 0.9e-3, 1.1e-3), ("m/s", 0.9e-2, 1.1e-2)] {
        let same = |by: f64| differences(&metric(unit, 0.0), &metric(unit, by), &engineering()).is_empty();
        assert!(same(within) && !same(beyond), "{unit}");
    }
    let interval = |t: f64| json!({ "sample_time_s": t });
    assert_eq!(differences(&interval(1e-4), &interval(1.1e-4), &engineering()), ["sample_time_s"]);
}

#[test]
fn coefficients_of_a_transfer_function_are_measured_near_its_roots() {
    // Roots near 100 rad/s: 1e-3 s² weighs as much as 10 at the end of the list.
    let tf = |square: f64| json!({"numerator": [square, 0.0, 1e4], "denominator": [1.0, 20.0, 1e4]});
    let settled = |by: f64| differences(&tf(by), &tf(0.0), &engineering());
    assert_eq!(settled(4e-3), Vec::<String>::new(), "40 of 10,000");
    assert_eq!(settled(6e-3), ["numerator[0]"], "60 of 10,000");
}

/// A file of another program: records of its own schemas.
fn foreign(records: &[(&str, &str, &[u8])]) -> Artifact {
    let mut file = Cursor::new(Vec::new());
    let mut writer = mcap::WriteOptions::new().create(&mut file).unwrap();
    let note = br#"{"stage":"x","notes":[]}"#.as_slice();
    for (k, (name, encoding, payload)) in [("crumple.Notes.v1", "json", note)].iter().chain(records).enumerate() {
        let schema = writer.add_schema(name, "", b"").unwrap();
        let channel = writer.add_channel(schema, &format!("/{k}"), encoding, &Default::default()).unwrap();
        let header = mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: 0, publish_time: 0 };
        writer.write_to_known_channel(&header, payload).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    Artifact::read(Path::new("x.mcap"), file.get_ref().as_slice()).unwrap()
}

#[test]
fn records_of_other_projects_are_compared_as_json_or_as_bytes() {
    let json_of = |x: u8| foreign(&[("mine.Pose", "json", format!("{{\"x\":{x}}}").as_bytes())]);
    let difference = only(&json_of(1), &json_of(2));
    assert_eq!((difference.place.as_str(), difference.a, difference.b), ("x", Some(json!(1)), Some(json!(2))));

    let bytes = |payload: &[u8], more: &[u8]| foreign(&[("mine.Raw", "raw", payload), ("mine.Raw", "raw", more)]);
    let difference = only(&bytes(b"abc", b"same"), &bytes(b"abd", b"same"));
    assert_eq!(difference.place, "bytes");
    let text = |value: Option<Value>| value.unwrap().as_str().unwrap().to_owned();
    let digest = |bytes: &[u8]| crumple_artifact::blake3_text(bytes);
    assert_eq!(text(difference.a), format!("3 bytes of \"raw\", {}", digest(b"abc")));
    assert_eq!(text(difference.b), format!("3 bytes of \"raw\", {}", digest(b"abd")));

    let difference = only(&foreign(&[("mine.Pose", "json", b"{}")]), &foreign(&[("mine.Place", "json", b"{}")]));
    assert_eq!(difference.place, "schema");
    assert_eq!((difference.a, difference.b), (Some(json!("mine.Pose")), Some(json!("mine.Place"))));
}

#[test]
fn records_of_other_counts_are_not_compared_one_by_one() {
    let many = |count: u32| {
        let mut file = Cursor::new(Vec::new());
        let mut writer = mcap::WriteOptions::new().create(&mut file).unwrap();
        let note = writer.add_schema("crumple.Notes.v1", "", b"").unwrap();
        let notes = writer.add_channel(note, "/notes", "json", &Default::default()).unwrap();
        let header = mcap::records::MessageHeader { channel_id: notes, sequence: 0, log_time: 0, publish_time: 0 };
        writer.write_to_known_channel(&header, br#"{"stage":"x","notes":[]}"#).unwrap();
        let schema = writer.add_schema("mine.Pose", "", b"").unwrap();
        let channel = writer.add_channel(schema, "/pose", "json", &Default::default()).unwrap();
        for sequence in 0..count {
            let header = mcap::records::MessageHeader { channel_id: channel, sequence, log_time: 0, publish_time: 0 };
            writer.write_to_known_channel(&header, b"{}").unwrap();
        }
        writer.finish().unwrap();
        drop(writer);
        Artifact::read(Path::new("x.mcap"), file.get_ref().as_slice()).unwrap()
    };
    let difference = only(&many(2), &many(3));
    assert_eq!(difference.place, "type");
    assert_eq!((difference.a, difference.b), (Some(json!("2 records")), Some(json!("3 records"))));
}

#[test]
fn every_value_is_counted_and_the_largest_relative_difference_told() {
    let compare = |a: &Value, b: &Value| compare_json("/x", a, b, &CompareSettings::default());
    let report = compare(&json!({"a": 1.0, "b": 2.0}), &json!({"a": 1.0 + 1e-10, "b": 2.0}));
    assert!(report.same && report.values == 2);
    let largest = report.max_rel.unwrap();
    assert!((0.9e-10..1.1e-10).contains(&largest), "{largest}");
    // within the absolute part a relative difference says nothing
    assert_eq!(compare(&json!(1e-13), &json!(2e-13)).max_rel, Some(0.0));
    let report = compare(&json!({"a": 1.0, "x": 5}), &json!({"a": 1.0, "y": 6}));
    assert_eq!((report.values, report.different), (3, 2));
    let sides: Vec<_> = report.differences.into_iter().map(|d| (d.place, d.a, d.b)).collect();
    let expected = [("x".to_owned(), Some(json!(5)), None), ("y".to_owned(), None, Some(json!(6)))];
    assert_eq!(sides, expected);
}

#[test]
fn values_of_records_and_texts_are_named() {
    let b = Made { olc: 256.5, notes: vec!["zero level 0.02 m/s^2".into(), "more".into()], ..Made::default() };
    let folder = pair(&b);
    let output = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(output.code, 1);
    insta::assert_snapshot!(output.stdout, @r#"
    different: no option, record or program differs: the numerics do
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
    let same = "same within tolerance: 228 values in 3 topics, none differs; one text differs and does not count\n";
    assert_eq!(output.stdout, same);
    let all = diff(folder.path(), &["a.mcap", "b.mcap", "--all"]).stdout;
    let note = "/notes, notes[0]: \"zero level 0.01 m/s^2\"  \"zero level 0.02 m/s^2\"  (for information)\n";
    assert_eq!(all, format!("{note}{same}"));
    let json = diff(folder.path(), &["a.mcap", "b.mcap", "--json", "--all"]);
    let json: Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!(json["files"][0]["file"]["topics"][1]["aside"][0]["place"], "notes[0]");
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
    let output = diff(folder.path(), &["a.mcap", "b.mcap", "--all"]);
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

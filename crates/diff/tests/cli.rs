//! The program as people and CI run it, on artifacts made here.

#![expect(clippy::unwrap_used, reason = "a test stops where something unforeseen happens")]

use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_artifact::records::{EventsV1, MetricV1, MetricsV1, NotesV1, SourceV1, TestV1, WaveBlockV1};
use crumple_artifact::{ArtifactBuilder, Codec, Compression, Provenance, Record};
use crumple_signal::{QuantityKind, Sampled, TestDescription};

struct Outcome {
    code: i32,
    stdout: String,
    stderr: String,
}

fn diff(folder: &Path, args: &[&str]) -> Outcome {
    let output = Command::new(env!("CARGO_BIN_EXE_crumple-diff")).args(args).current_dir(folder).output().unwrap();
    Outcome {
        code: output.status.code().unwrap(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

/// What an artifact of these tests is made of.
struct Made {
    samples: Vec<f64>,
    peak: f64,
    olc: f64,
    notes: Vec<String>,
    cfc: u16,
    compression: Compression,
}

impl Default for Made {
    fn default() -> Self {
        Self {
            // Exact in binary, so that the numbers in messages are the same everywhere.
            samples: (0..200).map(|k| f64::from(k % 40) * 2.5 - 50.0).collect(),
            peak: 445.75,
            olc: 255.0,
            notes: vec!["zero level 0.01 m/s^2".into()],
            cfc: 60,
            compression: Compression::None,
        }
    }
}

fn metric(name: &str, value: f64) -> MetricV1 {
    let text = String::new;
    MetricV1 {
        name: name.into(),
        value: Some(value),
        unit: "m/s^2".into(),
        channel: "93".into(),
        definition: text(),
        ..MetricV1::default()
    }
}

impl Made {
    fn metrics(&self) -> MetricsV1 {
        MetricsV1(vec![metric("peak_acceleration", self.peak), metric("olc", self.olc)])
    }

    fn record_notes(&self) -> NotesV1 {
        NotesV1 { stage: "integrate".into(), notes: self.notes.clone() }
    }

    fn write(&self, path: &Path) -> PathBuf {
        let mut builder = ArtifactBuilder::new();
        builder.put("/metrics", &self.metrics()).unwrap();
        builder.put("/notes", &self.record_notes()).unwrap();
        let sampled = Sampled::new(-0.01, 1e-4, self.samples.clone()).unwrap();
        builder.wave("93", QuantityKind::Acceleration, sampled).unwrap();
        let provenance = Provenance::new("integrate", "0.1.0", format!(r#"{{"cfc":{}}}"#, self.cfc), Vec::new());
        builder.write(path, &provenance, self.compression).unwrap();
        path.to_owned()
    }

    /// The same content as another program may write it: the other encodings, another order, other chunks.
    fn write_elsewhere(&self, path: &Path) {
        let mut file = Cursor::new(Vec::new());
        let mut writer = mcap::WriteOptions::new().library("elsewhere").chunk_size(Some(64)).create(&mut file).unwrap();
        let block = |first: usize, samples: &[f64]| WaveBlockV1 {
            t0_ns: -10_000_000,
            dt_s: 1e-4,
            first: first as u64,
            samples: samples.to_vec(),
        };
        let (head, tail) = self.samples.split_at(77);
        let quantity = BTreeMap::from([("quantity".to_owned(), "acceleration".to_owned())]);
        let messages = [
            ("/wave/93", WaveBlockV1::SCHEMA, "json", Codec::Json.encode(&block(0, head)).unwrap()),
            ("/wave/93", WaveBlockV1::SCHEMA, "json", Codec::Json.encode(&block(77, tail)).unwrap()),
            ("/notes", NotesV1::SCHEMA, "bincode", Codec::Bincode.encode(&self.record_notes()).unwrap()),
            ("/metrics", MetricsV1::SCHEMA, "bincode", Codec::Bincode.encode(&self.metrics()).unwrap()),
        ];
        for (k, (topic, schema, encoding, payload)) in messages.iter().enumerate() {
            let schema = writer.add_schema(schema, "jsonschema", b"{}").unwrap();
            let channel = writer.add_channel(schema, topic, encoding, &quantity).unwrap();
            let header =
                mcap::records::MessageHeader { channel_id: channel, sequence: k as u32, log_time: 7, publish_time: 7 };
            writer.write_to_known_channel(&header, payload).unwrap();
        }
        writer.finish().unwrap();
        drop(writer);
        fs::write(path, file.into_inner()).unwrap();
    }
}

/// `a.mcap` is the default; `b.mcap` is as told.
fn pair(b: &Made) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    Made::default().write(&folder.path().join("a.mcap"));
    b.write(&folder.path().join("b.mcap"));
    folder
}

#[test]
fn the_same_content_is_the_same_whatever_its_compression() {
    let folder = pair(&Made { compression: Compression::Zstd, ..Made::default() });
    let found = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!((found.code, found.stdout.as_str()), (0, "same: equal content\n"));
    assert_eq!(found.stderr, "");
}

#[test]
fn one_changed_sample_is_named_with_its_time_and_both_values() {
    let mut changed = Made::default();
    changed.samples[120] += 0.25;
    let folder = pair(&changed);
    let found = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(found.code, 1);
    insta::assert_snapshot!(found.stdout, @"
    /wave/93, sample 120 (t = 0.002000 s): -50.0  -49.75  (abs 0.25, rel 0.005), the only one of 200 samples
    different: 1 of 3 topics
    ");
    let json = diff(folder.path(), &["a.mcap", "b.mcap", "--json"]);
    assert_eq!(json.code, 1);
    let json: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!(json["same"], false);
    let wave = &json["files"][0]["topics"][2];
    assert_eq!((&wave["topic"], &wave["different"], &wave["values"]), (&"/wave/93".into(), &1.into(), &200.into()));
    assert_eq!(wave["differences"][0]["sample"], 120);
    assert_eq!(wave["differences"][0]["b"], changed.samples[120]);
    let quiet = diff(folder.path(), &["a.mcap", "b.mcap", "-q"]);
    assert_eq!((quiet.code, quiet.stdout.as_str(), quiet.stderr.as_str()), (1, "", ""));
}

#[test]
fn last_bits_are_the_same_by_default_and_not_exactly() {
    // 2e-12 of the largest sample: thousands of last bits, a five-hundredth of the default tolerance.
    let samples = Made::default().samples.iter().map(|x| x + 1e-10).collect();
    let folder = pair(&Made { samples, peak: 445.75 * (1.0 + 1e-12), ..Made::default() });
    let found = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(found.code, 0, "{}", found.stdout);
    insta::assert_snapshot!(found.stdout, @"same within tolerance: 224 values in 3 topics, the largest relative difference is 2.0e-12 in /wave/93");
    assert_eq!(diff(folder.path(), &["a.mcap", "b.mcap", "--exact"]).code, 1);
    assert_eq!(diff(folder.path(), &["a.mcap", "b.mcap", "--rel", "0", "--abs", "1e-8"]).code, 0);
    assert_eq!(diff(folder.path(), &["a.mcap", "b.mcap", "--rel", "1e-14"]).code, 1);
}

#[test]
fn a_zero_s_sign_is_seen_where_bits_are_asked_for() {
    let mut signed = Made::default();
    assert_eq!(signed.samples[20].to_bits(), 0);
    signed.samples[20] = -0.0;
    let folder = pair(&signed);
    assert_eq!(diff(folder.path(), &["a.mcap", "b.mcap", "--exact"]).code, 0);
    assert_eq!(diff(folder.path(), &["a.mcap", "b.mcap", "--bits"]).code, 1);
}

#[test]
fn values_of_records_and_texts_are_named() {
    let b = Made { olc: 256.5, notes: vec!["zero level 0.02 m/s^2".into(), "more".into()], ..Made::default() };
    let folder = pair(&b);
    let found = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(found.code, 1);
    insta::assert_snapshot!(found.stdout, @r#"
    /metrics, [olc].value: 255.0  256.5  (abs 1.5, rel 0.005848)
    /notes, notes length: 1  2
    /notes, notes[0]: "zero level 0.01 m/s^2"  "zero level 0.02 m/s^2"  (for information)
    different: 2 of 3 topics
    "#);
    // 1.5 of 256.5 is 0.58 %: beyond what an engineer calls the same; the texts differ anyway.
    let found = diff(folder.path(), &["a.mcap", "b.mcap", "--engineering"]);
    assert!(found.stdout.contains("/metrics, [olc].value"), "{}", found.stdout);
}

#[test]
fn notes_with_other_numbers_are_told_and_are_no_result() {
    let folder = pair(&Made { notes: vec!["zero level 0.02 m/s^2".into()], ..Made::default() });
    let found = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(found.code, 0, "{}", found.stdout);
    insta::assert_snapshot!(found.stdout, @r#"
    /notes, notes[0]: "zero level 0.01 m/s^2"  "zero level 0.02 m/s^2"  (for information)
    same within tolerance: 224 values in 3 topics, none differs; one text differs and is no result
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
    let found = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(found.code, 0, "{}", found.stdout);
    assert!(
        found.stdout.contains("/test, source.digest: \"blake3:00\"  \"blake3:11\"  (for information)"),
        "{}",
        found.stdout
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

#[test]
fn a_tolerance_file_widens_and_ignores_by_topic() {
    let b = Made { olc: 256.5, notes: vec![], ..Made::default() };
    let folder = pair(&b);
    let rules = "\"/metrics#[olc].value\" = { rel = 0.01 }\n\"/notes\" = { ignore = true }\n";
    fs::write(folder.path().join("t.toml"), rules).unwrap();
    let found = diff(folder.path(), &["a.mcap", "b.mcap", "--tolerance", "t.toml"]);
    assert_eq!(found.code, 0, "{}{}", found.stdout, found.stderr);
    fs::write(folder.path().join("t.toml"), "\"/notes\" = { ignore = true }\n").unwrap();
    assert_eq!(diff(folder.path(), &["a.mcap", "b.mcap", "--tolerance", "t.toml"]).code, 1);
    fs::write(folder.path().join("t.toml"), "\"/notes\" = { ignored = true }\n").unwrap();
    let wrong = diff(folder.path(), &["a.mcap", "b.mcap", "--tolerance", "t.toml"]);
    assert_eq!(wrong.code, 2);
    assert!(wrong.stderr.starts_with("error: tolerances: "), "{}", wrong.stderr);
}

#[test]
fn other_encodings_orders_and_chunks_of_the_same_content_are_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let made = Made::default();
    made.write(&folder.path().join("a.mcap"));
    made.write_elsewhere(&folder.path().join("b.mcap"));
    let found = diff(folder.path(), &["a.mcap", "b.mcap", "--bits"]);
    assert_eq!(found.code, 0, "{}{}", found.stdout, found.stderr);
    insta::assert_snapshot!(found.stdout, @"
    provenance: only in a.mcap  (for information)
    same within tolerance: 224 values in 3 topics, none differs
    ");
}

#[test]
fn another_option_is_told_and_counts_only_when_asked() {
    let folder = pair(&Made { cfc: 180, ..Made::default() });
    let found = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(found.code, 0);
    insta::assert_snapshot!(found.stdout, @"
    provenance, config.cfc: 60  180  (for information)
    same: equal content
    ");
    let found = diff(folder.path(), &["a.mcap", "b.mcap", "--provenance"]);
    assert_eq!(found.code, 1);
    assert!(found.stdout.ends_with("different: provenance\n"), "{}", found.stdout);
}

#[test]
fn damage_and_absence_are_trouble_not_difference() {
    let folder = pair(&Made::default());
    let good = fs::read(folder.path().join("a.mcap")).unwrap();
    fs::write(folder.path().join("cut.mcap"), &good[..good.len() / 2]).unwrap();
    let mut bad = good.clone();
    let middle = bad.len() / 2;
    bad[middle] ^= 4;
    fs::write(folder.path().join("bad.mcap"), bad).unwrap();

    for (file, says) in [
        ("cut.mcap", "cut.mcap: truncated: the file ends at byte"),
        ("bad.mcap", "bad.mcap: corrupted: chunk 1 at byte"),
        ("none.mcap", "cannot read none.mcap"),
    ] {
        for args in [["a.mcap", file], [file, "a.mcap"]] {
            let found = diff(folder.path(), &args);
            assert_eq!(found.code, 2, "{file}");
            assert!(found.stderr.starts_with("error: ") && found.stderr.contains(says), "{}", found.stderr);
            assert!(found.stderr.contains("\n  hint: "), "{}", found.stderr);
            assert!(found.stderr.matches("os error").count() <= 1, "the cause is told twice: {}", found.stderr);
            assert_eq!(found.stdout, "");
        }
    }
    assert_eq!(diff(folder.path(), &["a.mcap", "."]).code, 2, "a file beside a folder");
    assert_eq!(diff(folder.path(), &["a.mcap"]).code, 2, "usage");
    assert_eq!(diff(folder.path(), &["a.mcap", "b.mcap", "--rel", "-1"]).code, 2, "usage");
    assert_eq!(diff(folder.path(), &["--help"]).code, 0);
}

/// Two run folders of two artifacts and a summary.
fn runs() -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    for run in ["one", "two"] {
        let folder = root.path().join(run);
        fs::create_dir(&folder).unwrap();
        Made::default().write(&folder.join("2-filter.mcap"));
        Made::default().write(&folder.join("3-integrate.mcap"));
        fs::write(folder.join("summary.json"), r#"{"events": {"dynamic_crush_m": 0.75}}"#).unwrap();
        fs::write(folder.join("report.html"), run).unwrap();
    }
    root
}

#[test]
fn run_folders_are_compared_file_by_file() {
    let root = runs();
    let found = diff(root.path(), &["one", "two"]);
    assert_eq!(found.code, 0, "{}", found.stdout);
    let (one, two) = (root.path().join("one"), root.path().join("two"));

    let mut changed = Made::default();
    changed.samples[3] = 0.0;
    changed.write(&two.join("3-integrate.mcap"));
    fs::write(two.join("summary.json"), r#"{"events": {"dynamic_crush_m": 0.751}}"#).unwrap();
    fs::remove_file(two.join("2-filter.mcap")).unwrap();
    let found = diff(root.path(), &["one", "two"]);
    assert_eq!(found.code, 1);
    insta::assert_snapshot!(found.stdout, @"
    dynamic crush: 750.0 mm -> 751.0 mm
    2-filter.mcap: only in one
    3-integrate.mcap: /wave/93, sample 3 (t = -0.009700 s): -42.5  0.0  (abs 42.5, rel 0.85), the only one of 200 samples
    summary.json, events.dynamic_crush_m: 0.75  0.751  (abs 0.001, rel 0.001332)
    different: 2 of 4 topics in 3 files, 1 file on one side only
    ");

    fs::write(two.join("3-integrate.mcap"), &fs::read(one.join("3-integrate.mcap")).unwrap()[..99]).unwrap();
    assert_eq!(diff(root.path(), &["one", "two"]).code, 2, "damage goes before difference");
    fs::create_dir(root.path().join("empty")).unwrap();
    let found = diff(root.path(), &["one", "empty"]);
    assert_eq!(found.code, 2);
    assert!(found.stderr.starts_with("error: empty: no run folder"), "{}", found.stderr);
}

#[test]
fn a_topic_on_one_side_and_an_event_only_one_side_has_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let events = EventsV1 {
        channel: "93".into(),
        time_zero_s: 0.0,
        time_zero_rule: "file".into(),
        dynamic_crush_m: Some(0.75),
        ..EventsV1::default()
    };
    let write = |name: &str, events: &EventsV1, extra: bool| {
        let mut builder = ArtifactBuilder::new();
        builder.put("/events", events).unwrap();
        if extra {
            builder.put("/metrics", &Made::default().metrics()).unwrap();
        }
        let provenance = Provenance::new("integrate", "0.1.0", "{}".into(), Vec::new());
        builder.write(&folder.path().join(name), &provenance, Compression::None).unwrap();
    };
    write("a.mcap", &events, true);
    write("b.mcap", &EventsV1 { dynamic_crush_m: None, ..events.clone() }, false);
    write("c.mcap", &EventsV1 { dynamic_crush_m: Some(0.7509), ..events }, true);
    let found = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(found.code, 1);
    insta::assert_snapshot!(found.stdout, @"
    /events, dynamic_crush_m: 0.75  null
    /metrics: only in a.mcap
    different: 2 of 2 topics
    ");
    assert_eq!(diff(folder.path(), &["a.mcap", "c.mcap"]).code, 1);
    assert_eq!(diff(folder.path(), &["a.mcap", "c.mcap", "--engineering"]).code, 0, "0.9 mm of crush");
}

#[test]
fn waveforms_of_another_quantity_differ_though_their_messages_are_equal() {
    let folder = tempfile::tempdir().unwrap();
    for (name, quantity) in [("a.mcap", QuantityKind::Velocity), ("b.mcap", QuantityKind::Displacement)] {
        let mut builder = ArtifactBuilder::new();
        builder.wave("93", quantity, Sampled::new(0.0, 1.0, vec![1.0, 2.0]).unwrap()).unwrap();
        let provenance = Provenance::new("integrate", "0.1.0", "{}".into(), Vec::new());
        builder.write(&folder.path().join(name), &provenance, Compression::None).unwrap();
    }
    let found = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(found.code, 1);
    assert!(found.stdout.starts_with("/wave/93, quantity: \"velocity\"  \"displacement\"\n"), "{}", found.stdout);
}

//! The program as people and CI run it, on artifacts made here.

use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;
use std::path::Path;

use crumple_artifact::records::{CandidateV1, EventsV1, MetricsV2, NotesV1, WaveBlockV1};
use crumple_artifact::{ArtifactBuilder, Codec, Compression, Provenance, Record};
use crumple_signal::{QuantityKind, Sampled};
use crumple_stage::{Call, ExitStatus, Way};

use super::{Made, diff, pair};

/// The same content as another program may write it: the other encodings, another order, other chunks.
fn write_elsewhere(made: &Made, path: &Path) {
    let mut file = Cursor::new(Vec::new());
    let mut writer = mcap::WriteOptions::new().library("elsewhere").chunk_size(Some(64)).create(&mut file).unwrap();
    let block = |first: usize, samples: &[f64]| WaveBlockV1 {
        t0_ns: -10_000_000,
        dt_s: 1e-4,
        first: first as u64,
        samples: samples.to_vec(),
    };
    let (head, tail) = made.samples.split_at(77);
    let quantity = BTreeMap::from([("quantity".to_owned(), "acceleration".to_owned())]);
    let messages = [
        ("/wave/93", WaveBlockV1::SCHEMA, "json", Codec::Json.encode(&block(0, head)).unwrap()),
        ("/wave/93", WaveBlockV1::SCHEMA, "json", Codec::Json.encode(&block(77, tail)).unwrap()),
        ("/notes", NotesV1::SCHEMA, "bincode", Codec::Bincode.encode(&made.record_notes()).unwrap()),
        ("/metrics", MetricsV2::SCHEMA, "bincode", Codec::Bincode.encode(&made.metrics()).unwrap()),
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

#[test]
fn the_same_content_is_the_same_whatever_its_compression() {
    let folder = pair(&Made { compression: Compression::Zstd, ..Made::default() });
    let output = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!((output.code, output.stdout.as_str()), (0, "same: equal content\n"));
    assert_eq!(output.stderr, "");
}

#[test]
fn one_changed_sample_is_named_with_its_time_and_both_values() {
    let mut changed = Made::default();
    changed.samples[120] += 0.25;
    let folder = pair(&changed);
    let output = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(output.code, 1);
    insta::assert_snapshot!(output.stdout, @"
    different: no option, record or program differs: the numerics do
    /wave/93, sample 120 (t = 0.002000 s): -50.0  -49.75  (abs 0.25, rel 0.005), the only one of 200 samples
    different: 1 of 3 topics
    ");
    let json = diff(folder.path(), &["a.mcap", "b.mcap", "--json"]);
    assert_eq!(json.code, 1);
    let json: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!(json["same"], false);
    let wave = &json["files"][0]["file"]["topics"][0];
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
    let output = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(output.code, 0, "{}", output.stdout);
    insta::assert_snapshot!(output.stdout, @"same within tolerance: 228 values in 3 topics, the largest relative \
        difference is 2.0e-12 in /wave/93");
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
fn a_tolerance_file_widens_and_ignores_by_topic() {
    let b = Made { olc: 256.5, notes: vec![], ..Made::default() };
    let folder = pair(&b);
    let rules = "\"/metrics#[olc].value\" = { rel = 0.01 }\n\"/notes\" = { ignore = true }\n";
    fs::write(folder.path().join("t.toml"), rules).unwrap();
    let output = diff(folder.path(), &["a.mcap", "b.mcap", "--tolerance", "t.toml"]);
    assert_eq!(output.code, 0, "{}{}", output.stdout, output.stderr);
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
    write_elsewhere(&made, &folder.path().join("b.mcap"));
    let output = diff(folder.path(), &["a.mcap", "b.mcap", "--bits"]);
    assert_eq!(output.code, 0, "{}{}", output.stdout, output.stderr);
    assert_eq!(output.stdout, "same within tolerance: 228 values in 3 topics, none differs\n");
}

#[test]
fn another_option_is_told_and_counts_only_when_asked() {
    let folder = pair(&Made { cfc: 180, ..Made::default() });
    let output = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(output.code, 0);
    assert_eq!(output.stdout, "same: equal content\n");
    let all = diff(folder.path(), &["a.mcap", "b.mcap", "--all"]).stdout;
    assert!(all.starts_with("provenance, config.cfc: 60  180  (for information)\n"), "{all}");
    let output = diff(folder.path(), &["a.mcap", "b.mcap", "--provenance"]);
    assert_eq!(output.code, 1);
    assert!(output.stdout.ends_with("different: provenance\n"), "{}", output.stdout);
}

#[test]
fn a_topic_on_one_side_and_an_event_only_one_side_has_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let events = EventsV1 {
        channel: "93".into(),
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
    let output = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(output.code, 1);
    insta::assert_snapshot!(output.stdout, @"
    different: no option, record or program differs: the numerics do
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
    let output = diff(folder.path(), &["a.mcap", "b.mcap"]);
    assert_eq!(output.code, 1);
    assert!(output.stdout.contains("\n/wave/93, quantity: \"velocity\"  \"displacement\"\n"), "{}", output.stdout);
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
            let output = diff(folder.path(), &args);
            assert_eq!(output.code, 2, "{file}");
            assert!(output.stderr.starts_with("error: ") && output.stderr.contains(says), "{}", output.stderr);
            assert!(output.stderr.contains("\n  hint: "), "{}", output.stderr);
            assert!(output.stderr.matches("os error").count() <= 1, "the cause is told twice: {}", output.stderr);
            assert_eq!(output.stdout, "");
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
    let output = diff(root.path(), &["one", "two"]);
    assert_eq!(output.code, 0, "{}", output.stdout);
    let (one, two) = (root.path().join("one"), root.path().join("two"));

    let mut changed = Made::default();
    changed.samples[3] = 0.0;
    changed.write(&two.join("3-integrate.mcap"));
    fs::write(two.join("summary.json"), r#"{"events": {"dynamic_crush_m": 0.751}}"#).unwrap();
    fs::remove_file(two.join("2-filter.mcap")).unwrap();
    let output = diff(root.path(), &["one", "two"]);
    assert_eq!(output.code, 1);
    insta::assert_snapshot!(output.stdout, @"
  different: no option, record or program differs: the numerics do
  2-filter.mcap: only in one
  summary.json, events.dynamic_crush_m: 0.75  0.751  (abs 0.001, rel 0.001332)
  3-integrate.mcap: /wave/93, sample 3 (t = -0.009700 s): -42.5  0.0  (abs 42.5, rel 0.85), the only one of 200 samples
  different: 2 of 4 topics in 3 files, 1 file on one side only
  ");

    fs::write(two.join("3-integrate.mcap"), &fs::read(one.join("3-integrate.mcap")).unwrap()[..99]).unwrap();
    assert_eq!(diff(root.path(), &["one", "two"]).code, 2, "damage goes before difference");
    fs::create_dir(root.path().join("empty")).unwrap();
    let output = diff(root.path(), &["one", "empty"]);
    assert_eq!(output.code, 2);
    assert!(output.stderr.starts_with("error: empty: no run folder"), "{}", output.stderr);
}

/// A run whose candidate has this stiffness, in an artifact and in the summary.
pub fn run_of(folder: &Path, stiffness_n_per_m: f64) {
    fs::create_dir(folder).unwrap();
    let candidate = serde_json::json!({
        "model": "kelvin", "method": "direct-fit", "physical": true, "equivalent_to": null, "uncertainty": null,
        "parameters": {"k1_n_per_m": stiffness_n_per_m, "mass_kg": 900.0}, "notes": [],
        "fit": {"channel": "93", "quantity": "displacement", "from_s": 0.0, "to_s": 0.1, "samples": 100,
                "rmse": stiffness_n_per_m, "iterations": 3, "evaluations": 4, "stop_reason": "cost",
                "active_bounds": [], "sensors": []},
    });
    let record: CandidateV1 = serde_json::from_value(candidate.clone()).unwrap();
    let mut builder = ArtifactBuilder::new();
    builder.put("/parameters/kelvin/direct-fit/1", &record).unwrap();
    for wave in ["a", "b", "c", "d", "e"] {
        let samples = vec![0.0, stiffness_n_per_m, 1.0];
        builder.wave(wave, QuantityKind::Displacement, Sampled::new(0.0, 1e-4, samples).unwrap()).unwrap();
    }
    let provenance = Provenance::new("parameter-solve", "0.1.0", "{}".into(), Vec::new());
    builder.write(&folder.join("5-parameter-solve.mcap"), &provenance, Compression::None).unwrap();
    let mut listed = candidate;
    listed["id"] = "kelvin/direct-fit/1".into();
    let summary =
        serde_json::json!({"candidates": [listed], "metrics": {"olc": {"value": stiffness_n_per_m, "unit": "m/s^2"}}});
    fs::write(folder.join("summary.json"), summary.to_string()).unwrap();
}

#[test]
fn parameters_and_metrics_come_before_the_rest_and_waveforms_are_few() {
    let root = tempfile::tempdir().unwrap();
    run_of(&root.path().join("one"), 2.0);
    run_of(&root.path().join("two"), 4.0);
    let output = diff(root.path(), &["one", "two"]);
    assert_eq!(output.code, 1, "{}", output.stderr);
    insta::assert_snapshot!(output.stdout, @"
    different: no option, record or program differs: the numerics do
    5-parameter-solve.mcap: /parameters/kelvin/direct-fit/1, parameters.k1_n_per_m: 2.0  4.0  (abs 2, rel 0.5)
    summary.json, metrics.olc.value: 2.0  4.0  (abs 2, rel 0.5)
    5-parameter-solve.mcap: /parameters/kelvin/direct-fit/1, fit.rmse: 2.0  4.0  (abs 2, rel 0.5)
    5-parameter-solve.mcap: /wave/a, sample 1 (t = 0.000100 s): 2.0  4.0  (abs 2, rel 0.5), the only one of 3 samples
    5-parameter-solve.mcap: /wave/b, sample 1 (t = 0.000100 s): 2.0  4.0  (abs 2, rel 0.5), the only one of 3 samples
    5-parameter-solve.mcap: /wave/c, sample 1 (t = 0.000100 s): 2.0  4.0  (abs 2, rel 0.5), the only one of 3 samples
    5-parameter-solve.mcap: 2 more waveforms (--all shows them)
    summary.json, candidates[kelvin/direct-fit/1].fit.rmse: 2.0  4.0  (abs 2, rel 0.5)
    4 values are not compared: steps of solvers
    different: 7 of 7 topics in 2 files
    ");
    // Everything, the summary's repetitions too.
    let all = diff(root.path(), &["one", "two", "--all"]).stdout;
    assert_eq!(all.matches("parameters.k1_n_per_m: 2.0  4.0").count(), 2, "{all}");
    assert_eq!(all.matches("/wave/").count(), 5, "{all}");
}

#[test]
fn what_was_accepted_is_compared_with_later_runs_of_the_same_name() {
    let root = tempfile::tempdir().unwrap();
    let run = root.path().join("runs/car/default");
    fs::create_dir_all(run.parent().unwrap()).unwrap();
    let made = |crush: f64, cfc: u16| {
        _ = fs::remove_dir_all(&run);
        run_of(&run, 2.0);
        Made { cfc, ..Made::default() }.write(&run.join("2-filter.mcap"));
        let number = serde_json::json!({"name": "dynamic_crush", "value": crush, "unit": "m"});
        let summary = serde_json::json!({"schema": "crumple.summary.v1", "key_numbers": [number]});
        fs::write(run.join("summary.json"), summary.to_string()).unwrap();
    };
    made(0.75, 60);
    let [runs, expected] = ["runs", "expected"].map(|name| root.path().join(name).into_os_string());
    let words = vec![runs, "--into".into(), expected];
    let call = Call { program: "crumple accept".to_owned(), words, way: Way::Within };
    assert_eq!((crumple_report::ACCEPT.run)(&call), ExitStatus::Done);
    let written = || fs::metadata(root.path().join("expected/car.json")).unwrap().modified().unwrap();
    let first = written();
    assert_eq!((crumple_report::ACCEPT.run)(&call), ExitStatus::Done);
    assert_eq!(written(), first, "nothing changed");
    let same = diff(root.path(), &["expected", "runs", "--engineering"]);
    let said = "same within the limits: 1 number and the recommended model\n";
    assert_eq!((same.code, same.stdout.as_str()), (0, said));
    made(0.753, 180);
    let output = diff(root.path(), &["expected", "runs", "--engineering", "--markdown", "c.md", "--junit", "c.xml"]);
    assert_eq!(output.code, 1, "{}", output.stderr);
    assert!(output.stdout.starts_with("different because of integrate.cfc 60 -> 180"), "{}", output.stdout);
    assert!(output.stdout.ends_with("different from what was accepted\n"), "{}", output.stdout);
    assert!(output.stdout.lines().count() <= 25 && output.stdout.contains("+3.0\u{a0}mm"), "{}", output.stdout);
    for (file, words) in [("c.md", "crumple accept runs"), ("c.xml", "failures=\"1\"")] {
        let text = fs::read_to_string(root.path().join(file)).unwrap();
        assert!(text.contains(words), "{text}");
    }
    let text = fs::read_to_string(root.path().join("c.md")).unwrap();
    assert!(text.contains("To compare again, after new runs: `crumple-diff expected runs --markdown c.md`."), "{text}");
    // Its own files it writes again, no others.
    for flag in ["--markdown", "--junit", "--json"] {
        for code in [1, 1, 2] {
            if code == 2 {
                fs::write(root.path().join("file"), "mine").unwrap();
            }
            let output = diff(root.path(), &["expected", "runs", &format!("{flag}=file")]);
            assert_eq!(output.code, code, "{flag}: {}", output.stderr);
        }
        fs::remove_file(root.path().join("file")).unwrap();
    }
    fs::remove_dir_all(&run).unwrap();
    let output = diff(root.path(), &["expected", "runs"]);
    assert!(output.code == 2 && output.stderr.contains("hint"), "{}", output.stderr);
}

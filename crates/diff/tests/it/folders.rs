//! The program: run folders, and files that cannot be read.

use std::fs;
use std::path::Path;

use crumple_artifact::records::CandidateV1;
use crumple_artifact::{ArtifactBuilder, Compression, Provenance};
use crumple_signal::{QuantityKind, Sampled};

use crate::program::{Made, diff, pair};

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
  dynamic crush: 750.0 mm -> 751.0 mm
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
fn run_of(folder: &Path, stiffness_n_per_m: f64) {
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
    5-parameter-solve.mcap: /parameters/kelvin/direct-fit/1, parameters.k1_n_per_m: 2.0  4.0  (abs 2, rel 0.5)
    summary.json, metrics.olc.value: 2.0  4.0  (abs 2, rel 0.5)
    5-parameter-solve.mcap: /parameters/kelvin/direct-fit/1, fit.rmse: 2.0  4.0  (abs 2, rel 0.5)
    5-parameter-solve.mcap: /wave/a, sample 1 (t = 0.000100 s): 2.0  4.0  (abs 2, rel 0.5), the only one of 3 samples
    5-parameter-solve.mcap: /wave/b, sample 1 (t = 0.000100 s): 2.0  4.0  (abs 2, rel 0.5), the only one of 3 samples
    5-parameter-solve.mcap: /wave/c, sample 1 (t = 0.000100 s): 2.0  4.0  (abs 2, rel 0.5), the only one of 3 samples
    5-parameter-solve.mcap: 2 more waveforms (--all shows them)
    summary.json, candidates[kelvin/direct-fit/1].fit.rmse: 2.0  4.0  (abs 2, rel 0.5)
    different: 7 of 7 topics in 2 files
    ");
    // Everything, the summary's repetitions too.
    let all = diff(root.path(), &["one", "two", "--all"]).stdout;
    assert_eq!(all.matches("parameters.k1_n_per_m: 2.0  4.0").count(), 2, "{all}");
    assert_eq!(all.matches("/wave/").count(), 5, "{all}");
}

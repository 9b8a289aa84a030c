//! Every record with known lumped parameters as a user has it: ingest, CFC 60, integration, parameters.

use std::path::Path;
use std::process::Command;

use crumple_testkit::programs::binary;
use crumple_testkit::{KnownTruth, known_truths, known_truths_in, other_records, write_known_truth};
use serde_json::Value;

fn stage(name: &str, args: &[&str]) -> String {
    let output = Command::new(binary(name)).args(args).output().unwrap();
    assert!(output.status.success(), "{name} {args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs the stages with CFC 60 and returns the candidates.
fn candidates(record: &Path, truth: &Value, model: &str) -> Vec<Value> {
    let out = tempfile::tempdir().unwrap();
    let file = |name: &str| out.path().join(name).to_str().unwrap().to_owned();
    let [ingested, filtered, integrated, solved] = ["1.mcap", "2.mcap", "3.mcap", "5.mcap"].map(file);
    let masses: Vec<f64> = match &truth["mass_kg"] {
        Value::Array(masses) => masses.iter().map(|m| m.as_f64().unwrap()).collect(),
        mass => vec![mass.as_f64().unwrap()],
    };
    let mass = format!("{}kg", masses.iter().sum::<f64>());
    let speed = format!("{}m/s", truth["v0_m_s"]);
    let csv = record.join("accel.csv");
    stage("crumple-ingest", &[csv.to_str().unwrap(), "-o", &ingested, "--mass", &mass, "--impact-speed", &speed, "-q"]);
    stage("crumple-filter", &[&ingested, "-o", &filtered, "--cfc", "60", "-q"]);
    stage("crumple-integrate", &[&filtered, "-o", &integrated, "-q"]);
    let split: Vec<String> = match masses[..] {
        [m1, m2] => vec!["--m1".to_owned(), format!("{m1}kg"), "--m2".to_owned(), format!("{m2}kg")],
        _ => vec![],
    };
    let mut args = vec![filtered.as_str(), &integrated, "-o", &solved, "--models", model, "--json", "-q"];
    args.extend(split.iter().map(String::as_str));
    let text = stage("crumple-parameter-solve", &args);
    let lines = text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    lines.filter(|l| l["topic"].as_str().unwrap().starts_with("/parameters/")).map(|l| l["data"].clone()).collect()
}

/// The parameters under the names of the artifact; the last knot of a nonlinear spring at the measured crush, where a
/// fit has it, on the same line.
fn wanted(truth: &Value, model: &str, found: &Value) -> Vec<(&'static str, f64)> {
    let p = &truth["parameters"];
    let n = |key: &str| p[key].as_f64().unwrap();
    let list = |key: &str, k: usize| p[key][k].as_f64().unwrap();
    let at_crush = |i: usize| {
        let (from, to) = (list("k_knots", i), list("k_knots", i + 1));
        let crush = found["parameters"]["crush_m"].as_f64().unwrap();
        list("k_values", i) + (list("k_values", i + 1) - list("k_values", i)) * (crush - from) / (to - from)
    };
    match model {
        "kelvin" | "maxwell" => vec![("stiffness_n_per_m", n("k")), ("damping_n_s_per_m", n("c"))],
        "elastoplastic" => {
            vec![("loading_stiffness_n_per_m", n("k_E")), ("unloading_stiffness_n_per_m", n("k_P"))]
        }
        "nonlinear-1" => vec![
            ("k1_n_per_m", list("k_values", 0)),
            ("k2_n_per_m", at_crush(0)),
            ("c1_n_s_per_m", list("c_values", 0)),
            ("c2_n_s_per_m", list("c_values", 1)),
            ("c3_n_s_per_m", list("c_values", 2)),
            ("v_thresh_m_per_s", list("c_knots", 1)),
        ],
        "nonlinear-2" => vec![
            ("k1_n_per_m", list("k_values", 0)),
            ("k2_n_per_m", list("k_values", 1)),
            ("k3_n_per_m", at_crush(1)),
            ("x1_m", list("k_knots", 1)),
            ("c1_n_s_per_m", list("c_values", 0)),
            ("c2_n_s_per_m", list("c_values", 1)),
            ("c3_n_s_per_m", list("c_values", 2)),
            ("c4_n_s_per_m", list("c_values", 3)),
            ("v1_m_per_s", list("c_knots", 1)),
            ("v2_m_per_s", list("c_knots", 2)),
        ],
        _ => {
            vec![("k1_n_per_m", n("k1")), ("k2_n_per_m", n("k2")), ("c1_n_s_per_m", n("c1")), ("c2_n_s_per_m", n("c2"))]
        }
    }
}

/// Whether the value is within 2 % or the half-width that the artifact states, and the truth inside its 95 % interval.
fn holds(found: &Value, name: &str, truth: f64) -> (bool, String) {
    let value = found["parameters"][name].as_f64().unwrap();
    let end = |side: &str| found["uncertainty"][side][name].as_f64();
    let (low, high) = (end("interval_low"), end("interval_high"));
    let inside = low.is_none_or(|low| low <= truth) && high.is_none_or(|high| truth <= high);
    let stated = low.map_or(f64::INFINITY, |low| value - low).max(high.map_or(f64::INFINITY, |high| high - value));
    let near = (value - truth).abs() <= (0.02 * truth.abs()).max(stated);
    (inside && near, format!("{name}: {value} in {low:?} {high:?}, truth {truth}"))
}

/// The name of the model here; a nonlinear one by its number of knots.
fn model_of(known: &KnownTruth) -> &str {
    match known.model() {
        "double" => "double-spring-mass-damper",
        "nonlinear" => match known.truth["parameters"]["k_knots"].as_array().unwrap().len() {
            2 => "nonlinear-1",
            _ => "nonlinear-2",
        },
        other => other,
    }
}

fn check(known: &KnownTruth) {
    let (record, truth, model) = (&known.name, &known.truth, model_of(known));
    let found = candidates(&known.folder, truth, model);
    assert!(!found.is_empty(), "{record}: no candidate");
    let mut reports = Vec::new();
    let holding = found.iter().any(|candidate| {
        let all: Vec<(bool, String)> =
            wanted(truth, model, candidate).iter().map(|(name, value)| holds(candidate, name, *value)).collect();
        reports.extend(all.iter().map(|(_, text)| text.clone()));
        all.iter().all(|(holds, _)| *holds)
    });
    assert!(holding, "{record}: {reports:#?}");
    if let Some(dual) = truth["expected"]["dual_parameters"].as_object() {
        let dual = |name: &str| dual[name].as_f64().unwrap();
        let both = found.iter().any(|candidate| {
            [("k1_n_per_m", "k1"), ("k2_n_per_m", "k2"), ("c1_n_s_per_m", "c1"), ("c2_n_s_per_m", "c2")]
                .iter()
                .all(|(name, short)| holds(candidate, name, dual(short)).0)
        });
        assert!(both, "{record}: the dual is missing in {found:#?}");
    }
    let words = found[0]["uncertainty"]["weakest_direction"].as_str();
    assert!(words.is_some_and(|words| words.contains("displacement")), "{words:?}");
}

/// Every record of the folder whose model is among `models`.
fn check_all(models: &[&str]) {
    for known in known_truths().iter().filter(|known| known.is_lumped() && models.contains(&known.model())) {
        check(known);
    }
}

#[test]
fn single_masses_come_back_through_cfc_60() {
    check_all(&["kelvin", "elastoplastic", "maxwell"]);
}

#[test]
fn nonlinear_models_come_back_through_cfc_60() {
    check_all(&["nonlinear"]);
}

#[test]
fn double_models_and_their_duals_come_back_through_cfc_60() {
    check_all(&["double"]);
}

#[test]
fn no_record_of_the_folder_is_left_out() {
    for known in known_truths().iter().filter(|known| known.is_lumped()) {
        let checked = ["kelvin", "elastoplastic", "maxwell", "nonlinear", "double"].contains(&known.model());
        assert!(checked, "{}: no test for a model {:?}", known.name, known.model());
    }
}

#[test]
fn records_of_other_parameters_come_back_through_cfc_60() {
    let folder = tempfile::tempdir().unwrap();
    for (name, model, v0) in other_records() {
        write_known_truth(folder.path(), name, &model, v0).unwrap();
    }
    for known in known_truths_in(folder.path()) {
        check(&known);
    }
}

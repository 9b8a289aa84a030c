//! Predictions of a whole run: in the chain, asked for afterwards, and without a table in the pipeline.

use std::path::{Path, PathBuf};
use std::process::Output;

use crumple_testkit::pipeline::{just, number, run, summary_of};
use crumple_testkit::workspace;

fn fixture(name: &str) -> PathBuf {
    workspace().join("fixtures").join(name).join("crash.csv")
}

fn predict(folder: &Path, args: &[&str]) -> Output {
    just().args(["flags=-q", "predict"]).arg(folder).args(args).output().unwrap()
}

fn summary(folder: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(folder.join("summary.json")).unwrap()).unwrap()
}

/// Speed in km/h, mass in kg, candidate.
fn asked(summary: &serde_json::Value) -> Vec<(f64, f64, String)> {
    let predictions = summary["predictions"].as_array().unwrap().iter();
    predictions
        .map(|p| {
            let speed = (3.6 * number(p, &["impact_speed_m_per_s"]) * 1e3).round() / 1e3;
            (speed, number(p, &["mass_kg"]), p["candidate"].as_str().unwrap().to_owned())
        })
        .collect()
}

#[test]
fn a_run_predicts_the_speeds_of_its_pipeline_and_more_when_asked() {
    let folder = tempfile::tempdir().unwrap();
    let of_run = summary_of(&["flags=-q"], folder.path(), &fixture("kelvin"), &[]);
    let recommended = of_run["recommended"].as_str().unwrap();
    assert_eq!((of_run["best"].as_str(), recommended), (Some(recommended), "kelvin/direct-fit/1"));
    let mut speeds: Vec<f64> = asked(&of_run).iter().map(|(speed, ..)| *speed).collect();
    speeds.dedup();
    assert_eq!(speeds, [40.0, 48.0, 56.0, 64.0]);
    let flagged = of_run["predictions"].as_array().unwrap().iter().filter(|p| p["recommended"] == true);
    assert!(flagged.map(|p| p["candidate"].as_str().unwrap()).all(|id| id == recommended));

    // The test itself, 35 km/h, and a heavier car.
    let output = predict(folder.path(), &["--speed", "35km/h", "--candidate", recommended]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let own = summary(folder.path());
    assert_eq!(asked(&own).iter().map(|(speed, ..)| *speed).collect::<Vec<_>>(), [35.0, 40.0, 48.0, 56.0, 64.0]);
    let report = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert_eq!(report.matches("<strong>asked for</strong>").count(), 1);
    // The verdict answers what was asked; before, the slowest speed of the pipeline, which lies beyond the test.
    let sentences = own["verdict"]["sentences"].to_string().replace('\u{a0}', " ");
    assert!(sentences.contains("Asked for: at 35 km/h the Kelvin model gives 448 mm"), "{sentences}");
    assert!(!of_run["verdict"]["sentences"].to_string().contains("Asked for"), "{}", of_run["verdict"]);
    let crush = number(&own["predictions"][0], &["dynamic_crush_m"]);
    let measured = number(&own, &["events", "dynamic_crush_m"]);
    // The fit through the filter has the vehicle's own crush, 0.02 % from that of the filtered record: CFC 60 spreads
    // the jump of acceleration at contact over 10 ms on both sides.
    assert!((crush / measured - 1.0).abs() < 5e-4, "{crush} of {measured}");
    // The record answers at its own speed; the slope of its velocity is the mean of two samples, 5e-5 of a peak behind
    // CFC 60. The speeds of the pipeline lie beyond it.
    let (tested, faster) = (&own["predictions"][0], &own["predictions"][1]);
    let peak = number(tested, &["peak_acceleration_m_per_s2"]);
    let metric = number(&own, &["metrics", "peak_acceleration", "value"]).abs();
    assert!((peak / metric - 1.0).abs() < 1e-4, "{peak} of {metric}");
    let rebound = number(tested, &["coefficient_of_restitution"]);
    assert!((rebound - number(&own, &["events", "coefficient_of_restitution"])).abs() < 1e-12, "{rebound}");
    assert_eq!((tested["peak_by"].as_str(), tested["delta_v_by"].as_str()), (Some("record"), Some("record")));
    assert_eq!((faster["peak_by"].as_str(), faster["delta_v_by"].as_str()), (Some("model"), Some("model")));
    assert_eq!(own["pipeline"], "default");

    let output = predict(folder.path(), &["--mass", "1100kg"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(asked(&summary(folder.path())).iter().all(|(_, mass, _)| (*mass - 1100.0).abs() < 1e-9));
    let report = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(report.contains("<h2>Predictions</h2>") && report.contains("Which model to use</h2>"));

    let refused = predict(folder.path(), &["--speed", "0km/h"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(folder.path().join("7-predict.mcap").is_file());
}

#[test]
fn a_pipeline_without_the_table_predicts_nothing_and_sweeps_what_was_predicted() {
    let folder = tempfile::tempdir().unwrap();
    summary_of(&["flags=-q"], folder.path(), &fixture("elastoplastic"), &[]);
    assert!(folder.path().join("7-predict.mcap").is_file());
    let of_run = summary_of(&["flags=-q", "pipeline=unfiltered"], folder.path(), &fixture("elastoplastic"), &[]);
    assert!(!folder.path().join("7-predict.mcap").exists());
    assert_eq!(of_run["predictions"], serde_json::json!([]));
    assert!(of_run["recommended"].is_string() || of_run["recommended_because"].is_string());
}

#[test]
fn a_run_in_which_nothing_can_be_predicted_ends_with_its_report() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("sideways.csv");
    let text = std::fs::read_to_string(fixture("kelvin")).unwrap();
    std::fs::write(&record, text).unwrap();
    let out = folder.path().join("out");
    // Ten times the speed: the record ends long before the vehicle stops.
    let output = run(&["flags=-q"], &out, &record, &["--impact-speed", "350km/h"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let summary = summary(&out);
    assert!(summary["recommended"].is_null() && summary["best"].is_null());
    assert!(summary["recommended_because"].as_str().unwrap().contains("never reaches zero"), "{summary}");
    assert_eq!(summary["predictions"], serde_json::json!([]));
}

//! A stage written in another language takes the place of ours.

use crumple_testkit::pipeline::summary_of;
use crumple_testkit::workspace;

#[test]
fn a_python_program_that_writes_json_serves_as_identify() {
    let python = workspace().join(".venv/bin/python");
    assert!(python.exists(), "{} is missing: run scripts/setup.sh test", python.display());
    let script = workspace().join("docs/examples/identify.py");
    let folder = tempfile::tempdir().unwrap();
    let variable = format!("identify='{}' '{}'", python.display(), script.display());
    let summary = summary_of(&[&variable], folder.path(), &workspace().join("fixtures/kelvin/crash.csv"), &[]);
    let models = summary["models"].as_array().unwrap();
    assert_eq!(models.len(), 1, "{models:?}");
    assert_eq!(models[0]["id"], "ar-2");
    // The record is one decaying mode of sqrt(330000/873) = 19.442 rad/s; the coarse AR fit through the filter's
    // smeared contact finds it to a few percent.
    let found = models[0]["modes"][0]["natural_frequency_rad_per_s"].as_f64().unwrap();
    assert!((found / 19.442 - 1.0).abs() < 0.1, "{found}");
    assert!(!summary["candidates"].as_array().unwrap().is_empty(), "the stages after it went on");
}

//! What `just run` does around the stages: a run folder never mixes two records, and no mistake costs a finished run.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

use std::path::{Path, PathBuf};
use std::process::Output;

use crumple_testkit::pipeline::{ARTIFACTS, run};
use crumple_testkit::workspace;

fn fixture(name: &str) -> PathBuf {
    workspace().join("fixtures").join(name).join("crash.csv")
}

fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Names in the folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn complete() -> Vec<String> {
    ARTIFACTS.iter().chain(&["report.html", "summary.json"]).map(ToString::to_string).collect()
}

/// A folder with a finished run of the Kelvin fixture.
fn finished() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let output = run(&["flags=-q"], folder.path(), &fixture("kelvin"), &[]);
    assert!(output.status.success(), "{}", error(&output));
    assert_eq!(error(&output), "", "a first run replaces nothing");
    folder
}

#[test]
fn a_record_that_cannot_be_read_costs_nothing() {
    let folder = finished();
    let damaged = folder.path().with_extension("csv");
    std::fs::write(&damaged, "time_s,accel_g\n0,0\n").unwrap();
    for input in [Path::new("/nowhere/crash.csv"), &damaged] {
        let output = run(&["flags=-q"], folder.path(), input, &[]);
        assert_eq!(output.status.code(), Some(3), "{}", error(&output));
        assert_eq!(names(folder.path()), complete(), "{}", input.display());
        assert!(error(&output).contains("is that of an earlier run"), "{}", error(&output));
    }
    std::fs::remove_file(damaged).unwrap();
}

#[test]
fn a_stage_that_fails_leaves_no_results_of_another_record() {
    // A refusal, a crash of any other code, a death by signal.
    for identify in ["identify=bash -c 'exit 3'", "identify=bash -c 'exit 127'", "identify=bash -c 'kill -9 $$'"] {
        let folder = finished();
        let output = run(&["flags=-q", identify], folder.path(), &fixture("double"), &[]);
        assert!(!output.status.success(), "{identify}");
        assert_eq!(names(folder.path()), ARTIFACTS[..3], "{identify}: {}", error(&output));
    }
}

#[test]
fn a_stage_that_fails_leaves_the_results_of_the_same_record() {
    let folder = finished();
    let output = run(&["flags=-q", "identify=false"], folder.path(), &fixture("kelvin"), &[]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(names(folder.path()), complete());
}

#[test]
fn a_program_that_does_not_exist_is_noticed_before_anything_runs() {
    let folder = finished();
    let output = run(&["flags=-q", "simulate=no-such-program --flag"], folder.path(), &fixture("double"), &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(error(&output).contains("no-such-program: no such program"), "{}", error(&output));
    assert_eq!(names(folder.path()), complete());
}

#[test]
fn another_record_of_the_same_name_says_what_it_replaces() {
    let folder = finished();
    let output = run(&["flags=-q"], folder.path(), &fixture("double"), &[]);
    assert!(output.status.success());
    assert!(error(&output).contains("replaces the run of crash.csv (csv, content "), "{}", error(&output));
    // The same again: nothing to say.
    assert_eq!(error(&run(&["flags=-q"], folder.path(), &fixture("double"), &[])), "");
}

#[test]
fn what_ingest_prints_about_itself_ends_the_run() {
    for (flag, words) in [("--help", "Usage: crumple-ingest"), ("--version", "crumple-ingest "), ("--list", "accel_g")]
    {
        let folder = tempfile::tempdir().unwrap();
        let output = run(&[], folder.path(), &fixture("kelvin"), &[flag]);
        assert!(output.status.success(), "{flag}: {}", error(&output));
        assert!(String::from_utf8_lossy(&output.stdout).contains(words), "{flag}");
        assert_eq!((error(&output), names(folder.path())), (String::new(), vec![]), "{flag}");
    }
}

#[test]
fn a_flag_of_another_stage_is_told_whose_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(&[], folder.path(), &fixture("kelvin"), &["--mass=873kg", "--cfc", "180"]);
    assert_eq!(output.status.code(), Some(2));
    let error = error(&output);
    assert!(error.contains("tip: --cfc is an option of crumple-filter: just filter="), "{error}");
    assert!(!error.contains("--mass is"), "{error}");
}

#[test]
fn a_pipeline_may_lie_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("component.toml");
    std::fs::write(&own, "[filter]\ncfc = \"180\"\n\n[parameter-solve]\nmodels = [\"kelvin\"]\n").unwrap();
    let out = folder.path().join("run");
    let output = run(&["flags=-q", &format!("pipeline={}", own.display())], &out, &fixture("kelvin"), &[]);
    assert!(output.status.success(), "{}", error(&output));
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    assert!(summary.contains("kelvin") && !summary.contains("maxwell"), "only the models of that pipeline");
    // One that is not there is named.
    let missing = folder.path().join("none.toml");
    let output = run(&["flags=-q", &format!("pipeline={}", missing.display())], &out, &fixture("kelvin"), &[]);
    assert!(!output.status.success());
    assert!(error(&output).contains("none.toml"), "{}", error(&output));
}

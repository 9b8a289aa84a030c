//! The program on small artifacts: exit codes and what is written.

#![allow(clippy::unwrap_used, reason = "a failing helper is a failing test")]

use std::path::Path;
use std::process::{Command, Output};

use crumple_artifact::records::{CandidateV1, DiagnosisV1, EventsV1, MatchingV1, TestV1, TransferFunctionV1};
use crumple_artifact::{Artifact, ArtifactBuilder, Compression, Provenance};
use crumple_lumped::{Kelvin, Model};
use crumple_signal::{Channel, QuantityKind, Sampled, TestDescription};

fn kelvin() -> Kelvin {
    Kelvin { mass_kg: 873.0, stiffness_n_per_m: 330_000.0, damping_n_s_per_m: 2_500.0 }
}

/// The artifact integration would write for a car with these events.
fn write_integrated(path: &Path, mass_kg: Option<f64>, stops: bool) {
    let events = kelvin().events(9.7);
    let mut builder = ArtifactBuilder::new();
    let test = TestDescription {
        title: "a car".to_owned(),
        mass_kg,
        impact_speed_m_per_s: Some(9.7),
        channels: vec![Channel::new("a", QuantityKind::Acceleration)],
        ..TestDescription::default()
    };
    builder.put("/test", &TestV1::from(&test)).unwrap();
    let crash = EventsV1 {
        channel: "a".to_owned(),
        time_zero_s: 0.0,
        time_zero_rule: "file".to_owned(),
        dynamic_crush_m: events.dynamic_crush_m.filter(|_| stops),
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s.filter(|_| stops),
        impact_speed_m_per_s: Some(9.7),
        ..EventsV1::default()
    };
    builder.put("/events", &crash).unwrap();
    let response = Model::Kelvin(kelvin()).respond(9.7, 1e-4, 1001).unwrap();
    let x = Sampled::new(0.0, 1e-4, response.compartment().displacement_m.clone()).unwrap();
    builder.wave("a/displacement", QuantityKind::Displacement, x).unwrap();
    let provenance = Provenance::new("integrate", "0", "{}".to_owned(), Vec::new());
    builder.write(path, &provenance, Compression::None).unwrap();
}

fn run(folder: &Path, flags: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_crumple-parameter-solve"))
        .arg(folder.join("3.mcap"))
        .arg("-o")
        .arg(folder.join("5.mcap"))
        .args(flags)
        .output()
        .unwrap()
}

#[test]
fn exact_events_become_exact_parameters_in_the_artifact() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("3.mcap"), Some(873.0), true);
    let output = run(folder.path(), &["--models", "kelvin"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let artifact = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    let candidate: CandidateV1 = artifact.record("/parameters/kelvin/closed-form/1").unwrap().unwrap();
    // Rounding amplified by 1/0.59 twice.
    assert!((candidate.parameters["stiffness_n_per_m"] / 330_000.0 - 1.0).abs() < 1e-13);
    assert!((candidate.parameters["damping_n_s_per_m"] / 2_500.0 - 1.0).abs() < 1e-12);
    assert!(candidate.physical && candidate.fit.is_none());
    assert!(artifact.record::<TestV1>("/test").unwrap().is_some());
}

#[test]
fn a_missing_mass_is_named_in_the_diagnosis_and_a_flag_supplies_it() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("3.mcap"), None, true);
    let output = run(folder.path(), &[]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(4), "{stderr}");
    assert!(stderr.contains("the test has no mass") && stderr.contains("--mass 873kg"), "{stderr}");
    let written = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    assert!(written.record::<DiagnosisV1>("/diagnosis").unwrap().is_some());
    assert_eq!(run(folder.path(), &["--mass", "873kg", "--models", "kelvin"]).status.code(), Some(0));
}

#[test]
fn no_candidate_at_all_is_exit_4_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("3.mcap"), Some(873.0), false);
    let output = run(folder.path(), &["--models", "kelvin,elastoplastic"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(4), "{stderr}");
    assert!(stderr.contains("never reaches zero"), "{stderr}");
    // The diagnosis is written.
    assert!(Artifact::open(&folder.path().join("5.mcap")).is_ok());
}

#[test]
fn a_mistyped_method_is_a_usage_error_with_the_nearest_name() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("3.mcap"), Some(873.0), true);
    let output = run(folder.path(), &["--method", "direct-fti"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("did you mean \"direct-fit\"?"), "{stderr}");
}

#[test]
fn a_window_outside_the_record_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("3.mcap"), Some(873.0), true);
    let output = run(folder.path(), &["--fit-to", "2s"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(stderr.contains("0.1 s after time zero"), "{stderr}");
}

#[test]
fn closed_forms_need_the_events_only_and_are_exact() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("with-wave.mcap"), Some(873.0), true);
    let full = Artifact::open(&folder.path().join("with-wave.mcap")).unwrap();
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &full.record::<TestV1>("/test").unwrap().unwrap()).unwrap();
    builder.put("/events", &full.record::<EventsV1>("/events").unwrap().unwrap()).unwrap();
    let provenance = Provenance::new("by hand", "0", "{}".to_owned(), Vec::new());
    builder.write(&folder.path().join("3.mcap"), &provenance, Compression::None).unwrap();

    assert_eq!(run(folder.path(), &["--models", "kelvin"]).status.code(), Some(0));
    let solved = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    let candidate: CandidateV1 = solved.record("/parameters/kelvin/closed-form/1").unwrap().unwrap();
    // The inversion is a closed form with one bracketed root: rounding only.
    for (name, expected) in [("stiffness_n_per_m", 330_000.0), ("damping_n_s_per_m", 2_500.0)] {
        let found = candidate.parameters[name];
        assert!((found / expected - 1.0).abs() < 1e-9, "{name}: {found}");
    }

    // A fit needs the displacement, and says who writes it.
    let output = run(folder.path(), &[]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{error}");
    assert!(error.contains("/wave/a/displacement") && error.contains("crumple-integrate"), "{error}");
}

#[test]
fn a_typed_transfer_function_is_matched_with_every_solution_and_no_test_is_needed() {
    let folder = tempfile::tempdir().unwrap();
    let mut builder = ArtifactBuilder::new();
    let model = TransferFunctionV1 {
        numerator: vec![-76.15, 466.2],
        denominator: vec![1.0, 35.7, 6024.0, 185_000.0, 414_600.0],
        input: "force".to_owned(),
        output: "displacement".to_owned(),
    };
    builder.put("/model/civic", &model).unwrap();
    let provenance = Provenance::new("by hand", "0", "{}".to_owned(), Vec::new());
    builder.write(&folder.path().join("3.mcap"), &provenance, Compression::None).unwrap();
    let flags = ["--models", "double-spring-mass-damper", "--method", "coefficient-matching"];
    let output = run(folder.path(), &[&flags[..], &["--m1", "284.4kg", "--m2", "1137.6kg"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let solved = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    let matching: MatchingV1 = solved.record("/matching/civic").unwrap().unwrap();
    assert_eq!((matching.solutions.len(), matching.roots.len()), (6, 3));
    assert!((matching.largest_mass_ratio.unwrap() - 0.14703).abs() < 5e-6);
    let id = "double-spring-mass-damper/coefficient-matching";
    let first: CandidateV1 = solved.record(&format!("/parameters/{id}/1")).unwrap().unwrap();
    // The value of the identification reference, six decimals.
    assert!((first.parameters["c1_n_s_per_m"] - 34434.205385).abs() < 1e-6);
    assert!(!first.physical && first.equivalent_to == Some(format!("{id}/2")));
    assert_eq!(matching.solutions[1].candidate, Some(format!("{id}/2")));
    assert!(first.notes.iter().any(|note| note.contains("0.14703")), "{:?}", first.notes);
    assert!(first.notes.iter().any(|note| note.contains("6.1221") && note.contains("not consistent")));
    assert!(solved.record::<CandidateV1>(&format!("/parameters/{id}/3")).unwrap().is_none());
    // Masses have to be said.
    let output = run(folder.path(), &flags);
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--m1 284.4kg"));
}

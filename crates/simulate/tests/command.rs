//! The program on small artifacts: what is written for good and bad candidates.

#![allow(clippy::unwrap_used, reason = "a failing helper is a failing test")]

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};

use crumple_artifact::records::{CandidateV1, EventsV1, SimulationV1, TestV1};
use crumple_artifact::{Artifact, ArtifactBuilder, Compression, Provenance};
use crumple_lumped::{Kelvin, Model};
use crumple_signal::{Channel, QuantityKind, Sampled, TestDescription};

const MODEL: Kelvin = Kelvin { mass_kg: 873.0, stiffness_n_per_m: 330_000.0, damping_n_s_per_m: 2_500.0 };

fn candidate(model: &str, parameters: BTreeMap<String, f64>) -> CandidateV1 {
    CandidateV1 {
        model: model.to_owned(),
        method: "closed-form".to_owned(),
        parameters,
        physical: true,
        equivalent_to: None,
        fit: None,
        uncertainty: None,
        notes: Vec::new(),
    }
}

/// One artifact with the test's motion and these candidates.
fn write(path: &Path, candidates: &[(&str, CandidateV1)]) {
    let events = MODEL.events(9.7);
    let mut builder = ArtifactBuilder::new();
    let test = TestDescription {
        title: "a car".to_owned(),
        mass_kg: Some(873.0),
        impact_speed_m_per_s: Some(9.7),
        channels: vec![Channel::new("a", QuantityKind::Acceleration)],
        ..TestDescription::default()
    };
    builder.put("/test", &TestV1::from(&test)).unwrap();
    let crash = EventsV1 {
        channel: "a".to_owned(),
        time_zero_s: 0.0,
        time_zero_rule: "file".to_owned(),
        dynamic_crush_m: events.dynamic_crush_m,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        impact_speed_m_per_s: Some(9.7),
        ..EventsV1::default()
    };
    builder.put("/events", &crash).unwrap();
    let response = Model::Kelvin(MODEL).respond(9.7, 1e-4, 1001).unwrap();
    let x = Sampled::new(0.0, 1e-4, response.compartment().displacement_m.clone()).unwrap();
    builder.wave("a/displacement", QuantityKind::Displacement, x).unwrap();
    for (id, candidate) in candidates {
        builder.put(&format!("/parameters/{id}"), candidate).unwrap();
    }
    let provenance = Provenance::new("parameter-solve", "0", "{}".to_owned(), Vec::new());
    builder.write(path, &provenance, Compression::None).unwrap();
}

fn run(folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_crumple-simulate"))
        .arg(folder.join("5.mcap"))
        .arg("-o")
        .arg(folder.join("6.mcap"))
        .output()
        .unwrap()
}

#[test]
fn writes_response_and_comparison_of_every_candidate_it_can() {
    let folder = tempfile::tempdir().unwrap();
    let good = candidate("kelvin", Model::Kelvin(MODEL).parameters());
    let foreign = candidate("hyper-model", BTreeMap::from([("mass_kg".to_owned(), 1.0)]));
    write(&folder.path().join("5.mcap"), &[("kelvin/closed-form/1", good), ("hyper-model/guess/1", foreign)]);
    let output = run(folder.path());
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(stderr.contains("hyper-model/guess/1: not simulated, unknown model"), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let simulation: SimulationV1 = artifact.record("/simulation/kelvin/closed-form/1").unwrap().unwrap();
    // The record is the model's own: only rounding of the time stamps is left.
    assert!(simulation.rmse_displacement_m.unwrap() < 1e-14 && simulation.fit_percent.unwrap() > 100.0 - 1e-10);
    assert_eq!(simulation.dynamic_crush_error_m, Some(0.0));
    for quantity in ["displacement", "velocity", "acceleration"] {
        let wave = &artifact.waves()[&format!("kelvin/closed-form/1/{quantity}")];
        assert_eq!((wave.sampled.len(), wave.sampled.t0_s(), wave.sampled.dt_s()), (1001, 0.0, 1e-4));
    }
}

#[test]
fn no_candidate_that_can_be_simulated_is_exit_4_and_none_at_all_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let foreign = candidate("hyper-model", BTreeMap::new());
    write(&folder.path().join("5.mcap"), &[("hyper-model/guess/1", foreign)]);
    assert_eq!(run(folder.path()).status.code(), Some(4));
    write(&folder.path().join("5.mcap"), &[]);
    let output = run(folder.path());
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("crumple-parameter-solve"));
}

//! The program on small artifacts: what is written for good and bad candidates.

#![allow(clippy::unwrap_used, reason = "a failing helper is a failing test")]

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};

use crumple_artifact::records::{CandidateV1, EventsV1, SimulationV1, TestV1};
use crumple_artifact::{Artifact, ArtifactBuilder, Compression, Provenance};
use crumple_lumped::{DoubleSpringMassDamper, Kelvin, Model};
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

/// The program with more arguments.
fn run_with(folder: &Path, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_crumple-simulate"))
        .arg(folder.join("5.mcap"))
        .args(more)
        .arg("-o")
        .arg(folder.join("6.mcap"))
        .output()
        .unwrap()
}

const DOUBLE: DoubleSpringMassDamper = DoubleSpringMassDamper {
    m1_kg: 291.0,
    m2_kg: 582.0,
    k1_n_per_m: 3e5,
    k2_n_per_m: 4e5,
    c1_n_s_per_m: 4e3,
    c2_n_s_per_m: 6e3,
};

#[test]
fn writes_the_motion_of_every_mass_the_force_of_every_element_and_where_the_energy_went() {
    let folder = tempfile::tempdir().unwrap();
    let double = Model::DoubleSpringMassDamper(DOUBLE);
    let id = "double-spring-mass-damper/direct-fit/1";
    write(&folder.path().join("5.mcap"), &[(id, candidate("double-spring-mass-damper", double.parameters()))]);
    assert_eq!(run(folder.path()).status.code(), Some(0));
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let wave = |what: &str| artifact.waves()[&format!("{id}/{what}")].sampled.samples().to_vec();
    let response = double.respond(9.7, 1e-4, 1001).unwrap();
    assert_eq!(wave("m1/displacement"), response.motions[0].displacement_m);
    assert_eq!(wave("m1/acceleration"), response.motions[0].acceleration_m_per_s2);
    assert_eq!(wave("velocity"), response.motions[1].velocity_m_per_s);
    assert!(
        !artifact.waves().contains_key(&format!("{id}/m2/displacement")),
        "the compartment stands at the candidate"
    );
    for k in [0, 400, 1000] {
        let rear = wave("force/k2")[k] + wave("force/c2")[k];
        // The compartment is moved by the rear elements alone: forces near 1e5 N.
        assert!((rear + 582.0 * wave("acceleration")[k]).abs() < 1e-8);
        assert_eq!(artifact.waves()[&format!("{id}/force/c1")].quantity, QuantityKind::Force);
    }
    let simulation: SimulationV1 = artifact.record(&format!("/simulation/{id}")).unwrap().unwrap();
    assert!(simulation.energy_closure.unwrap() < 1e-11 && simulation.drive.is_none());
    let instants: Vec<&str> = simulation.energy.iter().map(|e| e.instant.as_str()).collect();
    assert_eq!(instants, ["start", "dynamic crush", "end"]);
    let impact = 0.5 * 873.0 * 9.7 * 9.7;
    for e in &simulation.energy {
        assert!((e.input_j - impact).abs() < 1e-9 * impact);
        assert!((e.kinetic_j + e.stored_j + e.dissipated_j - impact).abs() < 1e-9 * impact);
    }
}

#[test]
fn a_model_that_is_nearly_one_mass_gives_the_pulse_back_when_driven_by_it() {
    let folder = tempfile::tempdir().unwrap();
    // The shape of the transfer-function paper's best set: masses locked together, weak springs.
    let locked =
        DoubleSpringMassDamper { k1_n_per_m: 1.0, k2_n_per_m: 1.0, c1_n_s_per_m: 1.0, c2_n_s_per_m: 7e6, ..DOUBLE };
    let id = "double-spring-mass-damper/coefficient-matching/1";
    let locked = Model::DoubleSpringMassDamper(locked);
    write(&folder.path().join("5.mcap"), &[(id, candidate("double-spring-mass-damper", locked.parameters()))]);
    let output = run_with(folder.path(), &["--drive", "pulse-as-force"]);
    // The artifact has no pulse yet.
    assert_eq!(output.status.code(), Some(3));
    let mut builder = ArtifactBuilder::new();
    let pulse = Model::Kelvin(MODEL).respond(9.7, 1e-4, 1001).unwrap().compartment().acceleration_m_per_s2.clone();
    builder.wave("a", QuantityKind::Acceleration, Sampled::new(0.0, 1e-4, pulse).unwrap()).unwrap();
    let provenance = Provenance::new("filter", "0", "{}".to_owned(), Vec::new());
    builder.write(&folder.path().join("2.mcap"), &provenance, Compression::None).unwrap();
    let second = folder.path().join("2.mcap");
    let output = run_with(folder.path(), &[second.to_str().unwrap(), "--drive", "pulse-as-force"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(stderr.contains("circular"), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let simulation: SimulationV1 = artifact.record(&format!("/simulation/{id}")).unwrap().unwrap();
    // The answer that went in, but for the give of the damper between the masses, m2 v0/c2 at most.
    assert!(simulation.rmse_displacement_m.unwrap() < 582.0 * 9.7 / 7e6, "{simulation:?}");
    assert!(simulation.energy_closure.unwrap() < 1e-9 && simulation.drive.unwrap().contains("circular"));
    let usage = run_with(folder.path(), &["--drive", "puls-as-force"]);
    assert_eq!(usage.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&usage.stderr).contains("did you mean \"pulse-as-force\"?"));
    assert_eq!(run_with(folder.path(), &["--drive", "force"]).status.code(), Some(2));
}

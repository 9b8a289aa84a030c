//! The program on own models: files that `models` names.

use std::path::Path;
use std::process::Output;
use std::sync::Arc;

use crumple_artifact::records::{CandidateV1, EventsV1, NotesV1, TestV1};
use crumple_artifact::{Artifact, ArtifactBuilder};
use crumple_lumped::{HORIZON_S, Instants, Model, OwnLaw, OwnModel};
use crumple_signal::{Channel, QuantityKind, Sampled, TestDescription};

use crate::command_models;

const V0: f64 = 14.0;

/// A spring that hardens, a damper that grows with the crush, rigid unloading; engine and cabin.
const LAW: &str = r#"
[[mass]]
name = "engine"
mass = "20%"
[[mass]]
name = "cabin"
[[element]]
between = ["wall", "engine"]
force = "k*x + c*v*x^2"
unloading = "rigid"
[[element]]
between = ["engine", "cabin"]
force = "8e6*x + 2e4*v"
[parameters]
k = { unit = "N/m", start = 3e5, lower = 1e4, upper = 1e7 }
c = { unit = "N*s/m^3", start = 2e4, lower = 1e2, upper = 1e6 }
"#;

fn truth() -> OwnModel {
    OwnModel::at_start(Arc::new(OwnLaw::read(LAW).unwrap()), 1500.0).unwrap().with_values(&[300.0, 1200.0, 3e4, 5e5])
}

/// What integration leaves of a sensor in the cabin, with the displacement as it is.
fn write_integrated(path: &Path) {
    let structure = truth().structure().unwrap();
    let at = Instants { first_s: 0.0, dt_s: 1e-4, samples: 1201 };
    let motions = structure.motions_at(V0, &at).unwrap();
    let events = structure.events(V0, HORIZON_S).unwrap()[1];
    let test = TestDescription {
        title: "an own law".to_owned(),
        mass_kg: Some(1500.0),
        impact_speed_m_per_s: Some(V0),
        channels: vec![Channel::new("101", QuantityKind::Acceleration)],
        ..TestDescription::default()
    };
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &TestV1::from(&test)).unwrap();
    let crash = EventsV1 {
        channel: "101".to_owned(),
        time_zero_rule: "file".to_owned(),
        dynamic_crush_m: events.dynamic_crush_m,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        impact_speed_m_per_s: Some(V0),
        ..EventsV1::default()
    };
    builder.put("/events", &crash).unwrap();
    let x = Sampled::new(0.0, 1e-4, motions[1].displacement_m.clone()).unwrap();
    builder.wave("101/displacement", QuantityKind::Displacement, x).unwrap();
    command_models::write(&builder, path);
}

/// The program with a law in the file `my car.toml` beside the Kelvin model.
fn run(folder: &Path, law: &str) -> Output {
    write_integrated(&folder.join("3.mcap"));
    let file = folder.join("my car.toml");
    std::fs::write(&file, law).unwrap();
    command_models::run(folder, &["--models", &format!("kelvin,{}", file.display())])
}

#[test]
fn an_own_model_is_fitted_and_its_record_holds_its_law() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), LAW);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(stderr.contains("own/my-car/1: "), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    assert!(artifact.record::<CandidateV1>("/parameters/kelvin/closed-form/1").unwrap().is_some());
    let found: CandidateV1 = artifact.record("/parameters/own/my-car/1").unwrap().unwrap();
    for (name, value) in Model::Own(truth()).parameters() {
        // The displacement is the motion itself: rounding times the condition.
        assert!((found.parameters[&name] / value - 1.0).abs() < 1e-6, "{name}: {}", found.parameters[&name]);
    }
    assert_eq!(found.law.as_deref(), Some(LAW));
    let known = found.uncertainty.as_ref().unwrap();
    assert_eq!(known.order, ["c_n_s_per_m3", "k_n_per_m"]);
    assert_eq!(found.notes[0], "masses from the barrier on: engine, cabin");
    assert!(found.notes[1].starts_with("stated in a model file; fitted: "), "{:?}", found.notes);
    // From the record alone, without the file.
    std::fs::remove_file(folder.path().join("my car.toml")).unwrap();
    let model = Model::read(&found.model, found.law.as_deref(), &found.parameters).unwrap();
    assert_eq!(model.parameters(), found.parameters);
    let settings = &artifact.provenance().unwrap().config_json;
    assert!(settings.contains(r#""own":[["my-car","#), "{settings}");
}

#[test]
fn a_mistake_in_the_file_is_named_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), &LAW.replace("k*x +", "q*x +"));
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("my car.toml, line 9, column 10: found \"q\", expected one of x, v, c, k"), "{stderr}");
    let output = command_models::run(folder.path(), &["--models", "no_car.toml"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("cannot read the model file no_car.toml"), "{stderr}");
}

#[test]
fn a_law_that_divides_by_zero_has_no_candidate_and_the_others_stay() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), &LAW.replace("c*v*x^2", "c/x"));
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    assert!(artifact.record::<CandidateV1>("/parameters/kelvin/closed-form/1").unwrap().is_some());
    assert!(artifact.record::<CandidateV1>("/parameters/own/my-car/1").unwrap().is_none());
    let notes: NotesV1 = artifact.record("/notes").unwrap().unwrap();
    let says = "own/my-car: the force of element 1 is no number at x = 0 and v = 14.00 m/s";
    assert!(notes.notes.iter().any(|note| note.contains(says)), "{:?}", notes.notes);
}

//! The program on chains of masses that a pipeline file states.

use std::path::Path;
use std::process::Output;

use crumple_artifact::records::{CandidateV1, EventsV1, NotesV1, TestV1};
use crumple_artifact::{Artifact, ArtifactBuilder};
use crumple_lumped::{Chain, Drive, PiecewiseLinear};
use crumple_signal::{Channel, QuantityKind, Sampled, TestDescription};

use crate::command_models;

const V0: f64 = 14.0;

fn truth() -> Chain {
    let laws = |of: [f64; 3]| of.map(PiecewiseLinear::constant);
    Chain::new(&[250.0, 350.0, 900.0], &laws([9e5, 6e5, 1.1e6]), &laws([8e3, 2e4, 4e3])).unwrap()
}

/// What integration leaves of sensors on engine (101), chassis (102) and compartment (103), with displacements as they
/// are; one of them is the pulse.
fn write_integrated(path: &Path, pulse: &str) {
    let response = truth().respond(&Drive::Impact(V0), 1e-4, 1201).unwrap();
    let mut builder = ArtifactBuilder::new();
    let channels = ["101", "102", "103"];
    let place = channels.iter().position(|channel| *channel == pulse).unwrap();
    let events = truth().events(V0, 1.0).unwrap()[place];
    let test = TestDescription {
        title: "three masses".to_owned(),
        mass_kg: Some(1500.0),
        impact_speed_m_per_s: Some(V0),
        // One more than was integrated.
        channels: channels.iter().chain(&["104"]).map(|id| Channel::new(*id, QuantityKind::Acceleration)).collect(),
        ..TestDescription::default()
    };
    builder.put("/test", &TestV1::from(&test)).unwrap();
    let crash = EventsV1 {
        channel: pulse.to_owned(),
        time_zero_rule: "file".to_owned(),
        dynamic_crush_m: events.dynamic_crush_m,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        impact_speed_m_per_s: Some(V0),
        ..EventsV1::default()
    };
    builder.put("/events", &crash).unwrap();
    for (id, motion) in channels.iter().zip(&response.motions) {
        let x = Sampled::new(0.0, 1e-4, motion.displacement_m.clone()).unwrap();
        builder.wave(&format!("{id}/displacement"), QuantityKind::Displacement, x).unwrap();
    }
    command_models::write(&builder, path);
}

fn run(folder: &Path, pipeline: &str, flags: &[&str]) -> Output {
    write_integrated(&folder.join("3.mcap"), if pipeline.contains("occupant") { "102" } else { "103" });
    let file = folder.join("p.toml");
    std::fs::write(&file, pipeline).unwrap();
    command_models::run(folder, &[&["--pipeline", file.to_str().unwrap()], flags].concat())
}

const CAR: &str = r#"
[parameter-solve]
models = ["kelvin"]
sensors = ["engine=101", "chassis=102"]

[parameter-solve.chain.car]
masses = [
  { name = "engine", mass = { lower = "100 kg", upper = "500 kg" }, stiffness = "free", damping = "8 kN*s/m" },
  { name = "chassis", mass = "350 kg", stiffness = { start = "900 kN/m" }, damping = "free" },
  { name = "compartment", mass = "rest", stiffness = { lower = "100 kN/m", upper = "5 MN/m" }, damping = "free" },
]
"#;

#[test]
fn a_chain_of_the_pipeline_is_fitted_to_its_sensors_beside_the_other_models() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), CAR, &[]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(stderr.contains("chain/car/1: "), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    assert!(artifact.record::<CandidateV1>("/parameters/kelvin/closed-form/1").unwrap().is_some());
    let found: CandidateV1 = artifact.record("/parameters/chain/car/1").unwrap().unwrap();
    for (name, value) in truth().parameters() {
        // The displacement is the response itself: rounding times the condition.
        assert!((found.parameters[&name] / value - 1.0).abs() < 1e-6, "{name}: {}", found.parameters[&name]);
    }
    assert!(found.physical && artifact.record::<CandidateV1>("/parameters/chain/car/2").unwrap().is_none());
    let fit = found.fit.as_ref().unwrap();
    let sensors: Vec<(&str, u32)> = fit.sensors.iter().map(|s| (s.channel.as_str(), s.mass)).collect();
    assert_eq!(sensors, [("103", 3), ("101", 1), ("102", 2)]);
    let known = found.uncertainty.as_ref().unwrap();
    assert_eq!((known.rank, known.order.len()), (Some(6), 6));
    assert_eq!(found.notes[0], "masses from the barrier on: engine, chassis, compartment");
    assert!(found.notes.contains(&"given: c1_n_s_per_m, m2_kg".to_owned()), "{:?}", found.notes);
    let settings = &artifact.provenance().unwrap().config_json;
    assert!(settings.contains(r#""masses":["engine","chassis","compartment"]"#), "{settings}");
}

#[test]
fn an_occupant_is_the_mass_behind_the_compartment() {
    let folder = tempfile::tempdir().unwrap();
    let sled = CAR.replace("\"compartment\"", "\"occupant\"").replace("\"chassis\"", "\"compartment\"");
    let sled = sled.replace("\"chassis=102\"", "\"occupant=103\"");
    let output = run(folder.path(), &sled, &[]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    let found: CandidateV1 = artifact.record("/parameters/chain/car/1").unwrap().unwrap();
    let sensors: Vec<(String, u32)> =
        found.fit.as_ref().unwrap().sensors.iter().map(|s| (s.channel.clone(), s.mass)).collect();
    // The pulse is on the mass in front of the occupant.
    assert_eq!(sensors, [("102", 2), ("101", 1), ("103", 3)].map(|(channel, mass)| (channel.to_owned(), mass)));
    for (name, value) in truth().parameters() {
        // The displacement is the response itself: rounding times the condition.
        assert!((found.parameters[&name] / value - 1.0).abs() < 1e-6, "{name}: {}", found.parameters[&name]);
    }
}

#[test]
fn what_one_sensor_leaves_open_is_said() {
    let folder = tempfile::tempdir().unwrap();
    // Every mass free and no total: the whole model times any factor moves alike.
    let text = r#"
[parameter-solve]
models = ["kelvin"]
[parameter-solve.chain.loose]
masses = [{ mass = "free", stiffness = "free" }, { mass = "free", stiffness = "free", damping = "free" }]
"#;
    let output = run(folder.path(), text, &["--bootstrap", "20"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    let notes = format!("{:?}", artifact.record::<NotesV1>("/notes").unwrap().unwrap());
    assert!(notes.contains("chain loose: the record determines 4 directions of 5 free numbers"), "{notes}");
    assert!(notes.contains("chain loose: masses were fitted to a sensor on the last mass alone"), "{notes}");
    // No damping was stated for the first mass, the dual has some.
    assert!(notes.contains("is left out by what was given or by a bound, not by the record"), "{notes}");
    let found: CandidateV1 = artifact.record("/parameters/chain/loose/1").unwrap().unwrap();
    assert_eq!(found.uncertainty.unwrap().rank, Some(4));
}

#[test]
fn profile_bootstrap_and_uncertain_inputs_stand_in_the_record_of_a_chain() {
    let folder = tempfile::tempdir().unwrap();
    let flags = ["--profile", "--bootstrap", "20", "--mass-uncertainty", "15 kg", "--repetitions", "20"];
    let output = run(folder.path(), CAR, &flags);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(stderr.contains("chain/car/1: 20 repetitions with uncertain inputs: crush "), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    let found: CandidateV1 = artifact.record("/parameters/chain/car/1").unwrap().unwrap();
    let known = found.uncertainty.unwrap();
    let names = ["c2_n_s_per_m", "c3_n_s_per_m", "k1_n_per_m", "k2_n_per_m", "k3_n_per_m", "m1_kg", "m3_kg"];
    let mut profiled: Vec<&str> = known.profile.iter().map(|p| p.parameter.as_str()).collect();
    profiled.sort_unstable();
    assert_eq!(profiled, names);
    assert!(known.profile.iter().all(|profile| profile.identifiable), "{stderr}");
    assert!(known.bootstrap.unwrap().low.keys().eq(names));
    let propagation = known.propagation.unwrap();
    assert_eq!((propagation.replicates, propagation.low.len()), (20, 8));
    assert!(propagation.low["m3_kg"] < 900.0 && propagation.high["m3_kg"] > 900.0, "{propagation:?}");
    assert!(known.interval_low["m3_kg"].is_some());
}

#[test]
fn a_chain_and_its_dual_are_linked_and_a_chain_of_another_weight_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"
[parameter-solve]
models = ["kelvin"]
[parameter-solve.chain.light]
masses = [
    { mass = "300 kg", stiffness = "free", damping = "free" },
    { mass = "900 kg", stiffness = "free", damping = "free" },
]
"#;
    let output = run(folder.path(), text, &[]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let said = "its masses add up to 1200.0 kg, the test has 1500.0 kg: 20.0 % less (noted above 1 %)";
    assert!(stderr.contains(&format!("chain light: {said}")), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    let candidate =
        |k: usize| -> CandidateV1 { artifact.record(&format!("/parameters/chain/light/{k}")).unwrap().unwrap() };
    let (one, two) = (candidate(1), candidate(2));
    assert_eq!(one.equivalent_to.as_deref(), Some("chain/light/2"));
    assert_eq!(two.equivalent_to.as_deref(), Some("chain/light/1"));
    assert!(one.notes.iter().any(|note| note.starts_with(said)), "{:?}", one.notes);
    assert!(
        one.notes.iter().any(|note| note.starts_with("its dual chain/light/2 has the same masses")),
        "{:?}",
        one.notes
    );
    // mu = 4/3 of the dual's second spring.
    assert!((one.parameters["k1_n_per_m"] / (4.0 / 3.0 * two.parameters["k2_n_per_m"]) - 1.0).abs() < 1e-12);
}

#[test]
fn a_chain_that_makes_no_sense_is_refused_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let one = |mass: &str| format!("[parameter-solve.chain.odd]\nmasses = [{mass}]\n");
    for (text, code, expected) in [
        (one(r#"{ mass = "rest", stiffness = "free" }, { mass = "rest", stiffness = "free" }"#), 3, "two masses"),
        (one(r#"{ mass = "2000 kg", stiffness = "free" }, { mass = "rest", stiffness = "free" }"#), 3, "leave nothing"),
        (one(r#"{ mass = "200 kg", stiffness = "1 kN/m" }"#), 3, "nothing of the chain is free"),
        (one(r#"{ mass = "200 kg", stifness = "1 kN/m" }"#), 2, "did you mean \"stiffness\"?"),
        (one(r#"{ mass = "200 kg", stiffness = { lower = "0 N/m" } }"#), 3, "k1_n_per_m: 0 is not positive"),
        ("[parameter-solve.chain.\"a b\"]\n".to_owned(), 2, "letters, digits"),
    ] {
        let output = run(folder.path(), &text, &["--models", "kelvin"]);
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{text}{stderr}");
        assert!(stderr.contains(expected), "{stderr}");
    }
}

#[test]
fn a_sensor_that_was_not_integrated_is_named_with_where_to_add_it() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |sensors: &str| {
        let text = format!("[parameter-solve]\nmodels = ['double-spring-mass-damper']\nsensors = ['{sensors}']\n");
        let output = run(folder.path(), &text, &[]);
        assert_eq!(output.status.code(), Some(3), "{sensors}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let stderr = refused("m1=104");
    let expected = "channel 104, which sensors names, was not integrated\n  expected: a channel whose displacement the \
        inputs hold: \
                    101, 102, 103\n  hint: add \"104\" to channels of [integrate], or crumple-integrate --channels \
                    all,104\n";
    assert!(stderr.contains(expected), "{stderr}");
    let stderr = refused("m1=frnt");
    assert!(stderr.contains("the test has no channel \"frnt\", which sensors names"), "{stderr}");
}

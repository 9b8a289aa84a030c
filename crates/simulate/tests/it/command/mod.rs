//! The program on small artifacts: what is written for good and bad candidates.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};

use crumple_artifact::records::{
    CandidateV1, EvaluationV1, EventsV1, FitV1, OtherSensorV1, RatingV1, SensorFitV1, SimulationV1, TestV1,
};
use crumple_artifact::{Artifact, ArtifactBuilder, Compression, Provenance};
use crumple_lumped::{Chain, CrushEvents, DoubleSpringMassDamper, Drive, Kelvin, Model};
use crumple_signal::{Channel, QuantityKind, Sampled, TestDescription};
use crumple_testkit::{IMPACT_SPEED_M_PER_S, integrated};

mod drives;

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
        ..CandidateV1::default()
    }
}

/// One artifact with the test's motion and these candidates.
fn write(path: &Path, candidates: &[(&str, CandidateV1)]) {
    write_with(path, candidates, None);
}

/// The same of a record that does not stop, whose event ends at a stated time.
fn write_with(path: &Path, candidates: &[(&str, CandidateV1)], end_of_event_s: Option<f64>) {
    let events = if end_of_event_s.is_none() { MODEL.events(IMPACT_SPEED_M_PER_S) } else { CrushEvents::default() };
    let mut builder = integrated(&Model::Kelvin(MODEL), Some(873.0), &events, end_of_event_s).unwrap();
    for (id, candidate) in candidates {
        builder.put(&format!("/parameters/{id}"), candidate).unwrap();
    }
    let provenance = Provenance::new("parameter-solve", "0", "{}".to_owned(), Vec::new());
    builder.write(path, &provenance, Compression::None).unwrap();
}

/// The same of a test with further channels.
fn write_channels(path: &Path, candidates: &[(&str, CandidateV1)], channels: &[Channel]) {
    let mut builder = ArtifactBuilder::new();
    let crush = MODEL.events(IMPACT_SPEED_M_PER_S);
    let events = EventsV1 {
        channel: "a".to_owned(),
        time_zero_rule: "file".to_owned(),
        dynamic_crush_m: crush.dynamic_crush_m,
        time_of_dynamic_crush_s: crush.time_of_dynamic_crush_s,
        ..EventsV1::default()
    };
    builder.put("/events", &events).unwrap();
    let response = Model::Kelvin(MODEL).respond(IMPACT_SPEED_M_PER_S, 1e-4, 1001).unwrap();
    let displacement = Sampled::new(0.0, 1e-4, response.compartment().displacement_m.clone()).unwrap();
    builder.wave("a/displacement", QuantityKind::Displacement, displacement).unwrap();
    for (id, candidate) in candidates {
        builder.put(&format!("/parameters/{id}"), candidate).unwrap();
    }
    let test = TestDescription {
        title: "a car".to_owned(),
        mass_kg: Some(873.0),
        impact_speed_m_per_s: Some(IMPACT_SPEED_M_PER_S),
        channels: [&[Channel::new("a", QuantityKind::Acceleration)], channels].concat(),
        ..TestDescription::default()
    };
    builder.put("/test", &TestV1::from(&test)).unwrap();
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
    // The root of the exact solution beside the closed form: roundings of half a metre.
    assert!(simulation.dynamic_crush_error_m.unwrap().abs() < 1e-14);
    for quantity in ["displacement", "velocity", "acceleration"] {
        let wave = &artifact.waves()[&format!("kelvin/closed-form/1/{quantity}")];
        assert_eq!((wave.sampled.len(), wave.sampled.t0_s(), wave.sampled.dt_s()), (1501, 0.0, 1e-4));
    }
}

#[test]
fn a_candidate_is_evaluated_once_and_one_that_carries_nothing_of_this_window_here() {
    let folder = tempfile::tempdir().unwrap();
    let to_s = MODEL.events(IMPACT_SPEED_M_PER_S).time_of_dynamic_crush_s.unwrap();
    let carried = |to_s: f64| {
        let known = EvaluationV1 {
            to_s,
            fit_as_measured_percent: Some(77.0),
            force_misfit_percent: Some(7.0),
            ..EvaluationV1::default()
        };
        CandidateV1 { evaluation: Some(known), ..candidate("kelvin", Model::Kelvin(MODEL).parameters()) }
    };
    let stated = candidate("kelvin", Model::Kelvin(MODEL).parameters());
    let ids = ["kelvin/closed-form/1", "kelvin/closed-form/2", "kelvin/closed-form/3"];
    let all = [(ids[0], carried(to_s)), (ids[1], carried(0.5 * to_s)), (ids[2], stated)];
    write(&folder.path().join("5.mcap"), &all);
    assert_eq!(run(folder.path()).status.code(), Some(0));
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let [first, second, third] =
        ids.map(|id| -> SimulationV1 { artifact.record(&format!("/simulation/{id}")).unwrap().unwrap() });
    assert_eq!((first.fit_as_measured_percent, first.force_misfit_percent), (Some(77.0), Some(7.0)));
    for computed in [second, third] {
        // The record is the model's own, without a filter: rounding alone.
        assert!(computed.fit_as_measured_percent.unwrap() > 100.0 - 1e-9, "{:?}", computed.fit_as_measured_percent);
        assert_eq!(computed.force_misfit_percent, None);
    }
}

#[test]
fn every_candidate_is_rated_by_several_definitions_over_the_compared_window() {
    let folder = tempfile::tempdir().unwrap();
    let own = candidate("kelvin", Model::Kelvin(MODEL).parameters());
    let stiffer = Model::Kelvin(Kelvin { stiffness_n_per_m: 400_000.0, ..MODEL });
    let stiffer = candidate("kelvin", stiffer.parameters());
    write(&folder.path().join("5.mcap"), &[("kelvin/closed-form/1", own), ("kelvin/closed-form/2", stiffer)]);
    let pulse = write_pulse(folder.path());
    assert_eq!(run_with(folder.path(), &[&pulse]).status.code(), Some(0));
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let rated = |id: &str| {
        let simulation: SimulationV1 = artifact.record(&format!("/simulation/{id}")).unwrap().unwrap();
        for rating in &simulation.ratings {
            assert_eq!((rating.from_s, rating.to_s), (Some(0.0), Some(simulation.to_s)), "{}", rating.definition_id);
        }
        let value = |quantity: &str, definition: &str| {
            let of = |r: &&RatingV1| r.quantity == quantity && r.definition_id == definition;
            simulation.ratings.iter().find(of).unwrap().value.unwrap()
        };
        assert_eq!(simulation.iso18571_score, Some(value("acceleration", "iso18571")));
        let ids = ["cora", "sprague-geers-m", "sprague-geers-p", "sprague-geers-c", "theil-u1"];
        ["acceleration", "displacement"].map(|quantity| ids.map(|id| value(quantity, id)))
    };
    for [cora, m, p, c, u1] in rated("kelvin/closed-form/1") {
        // The model is the record: rounding, of which the phase keeps the root.
        assert!(cora > 1.0 - 1e-9 && m.abs() < 1e-12 && p < 1e-7 && c < 1e-7 && u1 < 1e-12);
    }
    for [cora, m, p, c, u1] in rated("kelvin/closed-form/2") {
        // 10 % faster: every rating sees it, and C is made of M and P.
        assert!(cora < 0.99 && p > 1e-3 && u1 > 0.01 && (c - m.hypot(p)).abs() < 1e-15);
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

/// The acceleration of the test, in an artifact of its own; its path.
fn write_pulse(folder: &Path) -> String {
    let mut builder = ArtifactBuilder::new();
    let pulse = Model::Kelvin(MODEL).respond(9.7, 1e-4, 1001).unwrap().compartment().acceleration_m_per_s2.clone();
    builder.wave("a", QuantityKind::Acceleration, Sampled::new(0.0, 1e-4, pulse).unwrap()).unwrap();
    let provenance = Provenance::new("filter", "0", "{}".to_owned(), Vec::new());
    let path = folder.join("2.mcap");
    builder.write(&path, &provenance, Compression::None).unwrap();
    path.to_str().unwrap().to_owned()
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
    let response = double.respond(9.7, 1e-4, 1501).unwrap();
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

fn run_pipeline(folder: &Path, text: &str) -> Output {
    std::fs::write(folder.join("p.toml"), text).unwrap();
    let pipeline = folder.join("p.toml");
    run_with(folder, &["--pipeline", pipeline.to_str().unwrap()])
}

#[test]
fn a_growing_model_is_said_to_diverge_and_its_energy_closes() {
    let folder = tempfile::tempdir().unwrap();
    // A root at +96.5/s: e^19 over the 0.1 s of the record.
    let growing = Model::Kelvin(Kelvin { mass_kg: 900.0, stiffness_n_per_m: 3e5, damping_n_s_per_m: -9e4 });
    let id = "kelvin/direct-fit/1";
    let candidate = CandidateV1 { physical: false, ..candidate("kelvin", growing.parameters()) };
    write(&folder.path().join("5.mcap"), &[(id, candidate)]);
    assert_eq!(run(folder.path()).status.code(), Some(0));
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let simulation: SimulationV1 = artifact.record(&format!("/simulation/{id}")).unwrap().unwrap();
    // 1,000 samples of 1e-15.
    assert!(simulation.energy_closure.unwrap() < 1e-12, "{:?}", simulation.energy_closure);
    assert!(simulation.notes.iter().any(|note| note.starts_with("warning: diverges")), "{:?}", simulation.notes);
}

#[test]
fn a_record_that_does_not_stop_is_compared_up_to_the_end_of_its_event() {
    let folder = tempfile::tempdir().unwrap();
    let kelvin = candidate("kelvin", Model::Kelvin(MODEL).parameters());
    write_with(&folder.path().join("5.mcap"), &[("kelvin/direct-fit/1", kelvin)], Some(0.05));
    let output = run(folder.path());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let simulation: SimulationV1 = artifact.record("/simulation/kelvin/direct-fit/1").unwrap().unwrap();
    // On the record's grid of 0.1 ms; it goes on to 100 ms.
    assert!((simulation.to_s - 0.05).abs() < 1e-9, "{}", simulation.to_s);
}

const CHAIN: &str = r#"
[simulate.chain.mine]
masses = [
  { name = "bumper", mass = "91 kg", stiffness = "900 kN/m" },
  { name = "engine", mass = "200 kg", stiffness = "300 kN/m", damping = "4 kN*s/m" },
  { name = "cabin", mass = "582 kg", stiffness = "400 kN/m", damping = "6 kN*s/m" },
]
"#;

#[test]
fn a_sensor_without_a_location_is_the_engines_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let double = Model::DoubleSpringMassDamper(DOUBLE);
    let id = "double-spring-mass-damper/direct-fit/1";
    let mut seat = Channel::new("engine_side_seat", QuantityKind::Acceleration);
    seat.location = "left rear seat".to_owned();
    let channels = [Channel::new("Engine", QuantityKind::Acceleration), seat];
    let candidates = [
        (id, candidate("double-spring-mass-damper", double.parameters())),
        ("kelvin/direct-fit/1", candidate("kelvin", Model::Kelvin(MODEL).parameters())),
    ];
    write_channels(&folder.path().join("5.mcap"), &candidates, &channels);
    let mut builder = ArtifactBuilder::new();
    let motions = double.respond(9.7, 1e-4, 1001).unwrap().motions;
    for (channel, motion) in channels.iter().zip(&motions) {
        let x = Sampled::new(0.0, 1e-4, motion.displacement_m.clone()).unwrap();
        builder.wave(&format!("{}/displacement", channel.id), QuantityKind::Displacement, x).unwrap();
    }
    let second = folder.path().join("3.mcap");
    builder.write(&second, &Provenance::new("x", "0", "{}".to_owned(), Vec::new()), Compression::None).unwrap();
    std::fs::write(folder.path().join("p.toml"), CHAIN).unwrap();
    let pipeline = folder.path().join("p.toml");
    let output = run_with(folder.path(), &[second.to_str().unwrap(), "--pipeline", pipeline.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let beside = |id: &str| -> Vec<OtherSensorV1> {
        artifact.record::<SimulationV1>(&format!("/simulation/{id}")).unwrap().unwrap().other_sensors
    };
    let masses = |id: &str| -> Vec<(String, u32)> {
        beside(id).into_iter().map(|sensor| (sensor.channel, sensor.mass)).collect()
    };
    let named = |engine: u32, last: u32| vec![("Engine".to_owned(), engine), ("engine_side_seat".to_owned(), last)];
    assert_eq!(masses(id), named(1, 2));
    // Exact motion of that mass: roundings of the time stamps.
    assert!(beside(id).iter().all(|sensor| sensor.fit_percent.unwrap() > 100.0 - 1e-9), "{:?}", beside(id));
    // The mass that the chain names after it; one mass alone is no engine.
    assert_eq!(masses("chain/mine/1"), named(2, 3));
    assert_eq!(masses("kelvin/direct-fit/1"), named(1, 1)[1..]);
}

#[test]
fn an_occupant_is_compared_with_its_own_sensor_and_the_compartment_with_the_pulse() {
    let folder = tempfile::tempdir().unwrap();
    // An occupant of 1 kg hardly moves the vehicle of the test, but is thrown far ahead of it.
    let sled = Chain::with_constants(&[MODEL.mass_kg, 1.0], &[MODEL.stiffness_n_per_m, 50.0], &[2_500.0, 5.0]).unwrap();
    let id = "chain/sled/1";
    let sensor = |channel: &str, mass: u32| SensorFitV1 {
        channel: channel.to_owned(),
        mass,
        quantity: "displacement".to_owned(),
        rmse: 0.0,
        noise: 1.0,
    };
    let mut fitted = candidate("chain", sled.parameters());
    fitted.fit = Some(FitV1 {
        channel: "a".to_owned(),
        quantity: "displacement".to_owned(),
        from_s: 0.0,
        to_s: 0.08,
        samples: 801,
        rmse: 0.0,
        iterations: 1,
        evaluations: 1,
        stop_reason: "cost-converged".to_owned(),
        active_bounds: Vec::new(),
        sensors: vec![sensor("a", 1), sensor("chest", 2)],
    });
    let chest = [Channel::new("chest", QuantityKind::Acceleration)];
    write_channels(&folder.path().join("5.mcap"), &[(id, fitted)], &chest);
    let motions = sled.respond(&Drive::Impact(IMPACT_SPEED_M_PER_S), 1e-4, 1001).unwrap().motions;
    let mut builder = ArtifactBuilder::new();
    let x = Sampled::new(0.0, 1e-4, motions[1].displacement_m.clone()).unwrap();
    builder.wave("chest/displacement", QuantityKind::Displacement, x).unwrap();
    let second = folder.path().join("3.mcap");
    builder.write(&second, &Provenance::new("x", "0", "{}".to_owned(), Vec::new()), Compression::None).unwrap();
    let output = run_with(folder.path(), &[second.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let record: SimulationV1 = artifact.record(&format!("/simulation/{id}")).unwrap().unwrap();
    assert_eq!(record.dynamic_crush_m, sled.events(IMPACT_SPEED_M_PER_S, 2.0).unwrap()[0].dynamic_crush_m);
    // The occupant pulls at the vehicle of the test with a thousandth of its mass.
    assert!(record.fit_percent.unwrap() > 99.0, "{record:?}");
    let beside: Vec<(&str, u32)> = record.other_sensors.iter().map(|s| (s.channel.as_str(), s.mass)).collect();
    assert_eq!(beside, [("chest", 2)]);
    // Exact motion of that mass: roundings of the time stamps.
    assert!(record.other_sensors[0].fit_percent.unwrap() > 100.0 - 1e-9, "{record:?}");
    let waves = artifact.waves();
    assert!(
        waves.contains_key(&format!("{id}/m2/displacement")) && !waves.contains_key(&format!("{id}/m1/displacement"))
    );
}

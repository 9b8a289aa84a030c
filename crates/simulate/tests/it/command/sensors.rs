//! Accelerometers that no fit has seen, beside the mass they sit on.

use crumple_artifact::records::{FitV1, OtherSensorV1, SensorFitV1};
use crumple_lumped::Drive;

use super::*;

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

//! Accelerometers that no fit has seen, beside the mass they sit on.

use crumple_artifact::records::OtherSensorV1;

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

//! Two cars that meet: each with its own speed and mass, and what both say together, on motions with known truth.

use std::path::{Path, PathBuf};

use crumple_artifact::records::{MetricV1, MetricsV2, NotesV1, TestV1, VehicleV1, VehiclesV1};
use crumple_artifact::{Artifact, ArtifactBuilder, Compression, Provenance};
use crumple_signal::{Axis, Channel, QuantityKind, Sampled, TestDescription};
use crumple_testkit::TwoVehicles;
use crumple_testkit::program::Program;

const PROGRAM: Program = Program { exe: env!("CARGO_BIN_EXE_crumple-integrate"), output: "3-integrate.mcap" };

/// What the filter stage would have written: the pulse `1` and a further sensor `2` of the first car, `4` and `5` of
/// the second.
fn filtered(folder: &Path, cars: &TwoVehicles) -> PathBuf {
    let channel = |id: &str, location: &str| Channel {
        location: location.to_owned(),
        axis: Some(Axis::X),
        ..Channel::new(id, QuantityKind::Acceleration)
    };
    let test = TestDescription {
        title: "two cars".to_owned(),
        mass_kg: Some(cars.masses_kg[0]),
        impact_speed_m_per_s: Some(cars.speeds_km_per_h[0] / 3.6),
        channels: vec![
            channel("1", "vehicle, rear floor, left"),
            channel("2", "vehicle, rear floor, right"),
            channel("4", "vehicle 2, rear floor, left"),
            channel("5", "vehicle 2, rear floor, right"),
        ],
        pulse: Some("1".to_owned()),
        ..TestDescription::default()
    };
    let vehicle = |k: usize, channels: [&str; 2]| VehicleV1 {
        number: k as u32 + 1,
        description: None,
        mass_kg: Some(cars.masses_kg[k]),
        impact_speed_m_per_s: Some(cars.speeds_km_per_h[k] / 3.6),
        pulse: Some(channels[0].to_owned()),
        channels: channels.map(str::to_owned).to_vec(),
    };
    let vehicles = vec![vehicle(0, ["1", "2"]), vehicle(1, ["4", "5"])];
    let closing_speed_m_per_s = Some(cars.closing_speed_m_per_s());
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &TestV1::from(&test)).unwrap();
    builder.put("/vehicles", &VehiclesV1 { vehicles, closing_speed_m_per_s }).unwrap();
    for (id, k) in [("1", 0), ("2", 0), ("4", 1), ("5", 1)] {
        let samples = (0..2500).map(|n| cars.acceleration_m_per_s2(k, f64::from(n - 500) * 1e-4)).collect();
        let wave = Sampled::new(-0.05, 1e-4, samples).unwrap();
        builder.wave(id, QuantityKind::Acceleration, wave).unwrap();
    }
    let path = folder.join("2-filter.mcap");
    builder.write(&path, &Provenance::new("filter", "0", "{}".to_owned(), vec![]), Compression::None).unwrap();
    path
}

fn metric<'a>(metrics: &'a [MetricV1], channel: &str, name: &str) -> &'a MetricV1 {
    metrics.iter().find(|metric| metric.channel == channel && metric.name == name).unwrap()
}

#[test]
fn both_vehicles_are_reported_with_what_they_say_together() {
    let both_move = TwoVehicles { speeds_km_per_h: [50.0, 40.0], ..TwoVehicles::STANDING };
    let from_behind = TwoVehicles { speeds_km_per_h: [60.0, 20.0], same_heading: true, ..TwoVehicles::STANDING };
    for cars in [TwoVehicles::STANDING, both_move, from_behind] {
        let folder = tempfile::tempdir().unwrap();
        let input = filtered(folder.path(), &cars);
        let artifact = Artifact::open(&PROGRAM.written(&input, &["--channels", "all"])).unwrap();
        let metrics = artifact.record::<MetricsV2>("/metrics").unwrap().unwrap().metrics;
        let value = |name: &str| metric(&metrics, "1+4", name).value.unwrap();
        let (crush_m, time_s) = cars.relative_crush();
        // Sums of 10 kHz samples by the trapezoid.
        assert!((value("relative_crush") - crush_m).abs() < 1e-5, "{cars:?}");
        assert!((value("time_of_common_velocity") - time_s).abs() < 1e-6, "{cars:?}");
        assert!((value("common_velocity") - cars.common_velocity_m_per_s()).abs() < 1e-4, "{cars:?}");
        assert!((value("common_velocity_by_momentum") - cars.common_velocity_m_per_s()).abs() < 1e-12, "{cars:?}");
        assert!(value("momentum_gap").abs() < 1e-6 && (value("coefficient_of_restitution") - 1.0).abs() < 1e-4);
        // The second car has its own mass and speed, and its sensors serve nobody else.
        let of_second = |name: &str| metric(&metrics, "4", name);
        let energy = 0.5 * cars.masses_kg[1] * (cars.speeds_km_per_h[1] / 3.6).powi(2);
        assert!((of_second("impact_energy").value.unwrap() - energy).abs() < 1e-6);
        assert!(!metrics.iter().any(|metric| metric.channel.contains('5')));
        assert!(artifact.waves().contains_key("2/displacement") && !artifact.waves().contains_key("4/displacement"));
        assert!(artifact.waves().contains_key("4/velocity"));
        let notes = artifact.record::<NotesV1>("/notes").unwrap().unwrap().notes.join("\n");
        assert!(!notes.contains("check the impact speed"), "a partner leaves speed: {notes}");
    }
}

#[test]
fn a_wrong_mass_shows_in_the_momentum() {
    let folder = tempfile::tempdir().unwrap();
    let cars = TwoVehicles::STANDING;
    let input = filtered(folder.path(), &cars);
    let mut artifact = Artifact::open(&input).unwrap().record::<VehiclesV1>("/vehicles").unwrap().unwrap();
    artifact.vehicles[1].mass_kg = Some(800.0);
    let mut builder = ArtifactBuilder::new();
    let old = Artifact::open(&input).unwrap();
    builder.put("/test", &old.record::<TestV1>("/test").unwrap().unwrap()).unwrap();
    builder.put("/vehicles", &artifact).unwrap();
    for (id, wave) in old.waves() {
        builder.wave(id, wave.quantity, wave.sampled.clone()).unwrap();
    }
    builder.write(&input, &Provenance::new("filter", "0", "{}".to_owned(), vec![]), Compression::None).unwrap();
    let result = Artifact::open(&PROGRAM.written(&input, &[])).unwrap();
    let notes = result.record::<NotesV1>("/notes").unwrap().unwrap().notes.join("\n");
    assert!(notes.contains("warning: momentum") && notes.contains("-50.0 %"), "{notes}");
}

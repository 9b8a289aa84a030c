//! The program on tests with several channels: further accelerometers, a contact switch, a load-cell barrier.

use std::path::{Path, PathBuf};

use crumple_artifact::records::{MetricV1, MetricsV2, NotesV1, TestV1, VehicleV1, VehiclesV1};
use crumple_artifact::{Artifact, ArtifactBuilder, Compression, Provenance};
use crumple_signal::{Axis, Channel, ChannelStatus, QuantityKind, Sampled, TestDescription};
use crumple_testkit::TwoVehicles;

use crate::{PROGRAM, events, result, run};

const MASS_KG: f64 = 1000.0;

/// A constant deceleration from contact to 150 ms, 50 ms at rest before it, 1 ms of ramp at either end.
fn braking(level: f64, contact_s: f64) -> Sampled {
    let at = |t: f64| -level * ((t - contact_s) / 1e-3).clamp(0.0, 1.0) * ((0.151 - t) / 1e-3).clamp(0.0, 1.0);
    Sampled::new(-0.05, 1e-4, (0..2500).map(|k| at(f64::from(k) * 1e-4 - 0.05)).collect()).unwrap()
}

fn channel(id: &str, location: &str, quantity: QuantityKind) -> Channel {
    Channel { location: location.to_owned(), axis: Some(Axis::X), cfc: Some(60), ..Channel::new(id, quantity) }
}

/// Three accelerometers, an engine, a switch and three load cells of which one is dead.
fn test_folder(folder: &Path) -> PathBuf {
    use QuantityKind::{Acceleration, Force, Voltage};
    let force = |share: f64| {
        let samples = braking(120.0, 0.0).samples().iter().map(|a| share * MASS_KG * a).collect();
        Sampled::new(-0.05, 1e-4, samples).unwrap()
    };
    let switch = (0..2500).map(|k| if k < 520 { 5.0 } else { 0.0 }).collect();
    let mut waves = vec![
        (channel("1", "vehicle, left sill", Acceleration), braking(120.0, 0.0)),
        (channel("2", "vehicle, right sill", Acceleration), braking(122.0, 0.0)),
        (channel("3", "vehicle, rear passenger floor", Acceleration), braking(118.0, 0.0)),
        (channel("4", "vehicle, top of engine", Acceleration), braking(300.0, 0.0)),
        (channel("5", "vehicle, contact", Voltage), Sampled::new(-0.05, 1e-4, switch).unwrap()),
        (channel("6", "barrier, load cell A", Force), force(0.6)),
        (channel("7", "barrier, load cell B", Force), force(0.4)),
        (channel("8", "barrier, load cell C", Force), force(0.1)),
        (Channel { axis: Some(Axis::Y), ..channel("9", "vehicle, left sill", Acceleration) }, braking(120.0, 0.0)),
    ];
    waves[7].0.status = ChannelStatus::Questionable;
    let test = TestDescription {
        title: "several".to_owned(),
        mass_kg: Some(MASS_KG),
        impact_speed_m_per_s: Some(15.0),
        pulse: Some("1".to_owned()),
        channels: waves.iter().map(|(channel, _)| channel.clone()).collect(),
        ..TestDescription::default()
    };
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &TestV1::from(&test)).unwrap();
    for (channel, samples) in waves {
        builder.wave(&channel.id, channel.quantity, samples).unwrap();
    }
    let path = folder.join("2-filter.mcap");
    builder.write(&path, &Provenance::new("filter", "0", "{}".to_owned(), vec![]), Compression::None).unwrap();
    path
}

fn notes(artifact: &Artifact) -> Vec<String> {
    artifact.record::<NotesV1>("/notes").unwrap().unwrap().notes
}

fn metric(artifact: &Artifact, channel: &str, name: &str) -> Option<f64> {
    let metrics: MetricsV2 = artifact.record("/metrics").unwrap().unwrap();
    metrics
        .metrics
        .iter()
        .find(|metric| metric.channel == channel && metric.name == name)
        .and_then(|metric| metric.value)
}

#[test]
fn all_means_the_compartment_and_the_events_stay_those_of_the_pulse() {
    let folder = tempfile::tempdir().unwrap();
    let input = test_folder(folder.path());
    let artifact = result(&input, &["--channels", "all"]);
    for id in ["1", "2", "3"] {
        assert!(artifact.waves().contains_key(&format!("{id}/displacement")), "{id}");
        assert!(metric(&artifact, id, "dynamic_crush").is_some(), "{id}");
    }
    assert!(!artifact.waves().contains_key("4/displacement"));
    assert_eq!(events(&artifact).channel, "1");
    let notes = notes(&artifact);
    assert!(notes.iter().any(|note| note.contains("not in the compartment: channels 4")), "{notes:?}");
    assert!(notes.iter().any(|note| note.starts_with("dynamic crush of 3 channels: 0.9")), "{notes:?}");

    assert!(notes.iter().any(|note| note.starts_with("channel 2 against 1: largest |da| 0.20 g")), "{notes:?}");

    let artifact = result(&input, &["--channels", "4"]);
    assert!(artifact.waves().contains_key("4/displacement"));
    // A name twice is once; what is named beside all is taken along whatever axis.
    let artifact = result(&input, &["--channels", "all,4,9,9"]);
    assert!(["2", "3", "4", "9"].iter().all(|id| artifact.waves().contains_key(&format!("{id}/displacement"))));
    assert_eq!(run(&input, &["--channels", "10"]).status.code(), Some(3));
    assert_eq!(run(&input, &["--channels", "6"]).status.code(), Some(3));
}

#[test]
fn the_spread_of_the_channels_is_the_interval_of_every_metric_and_an_engine_is_not_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let input = test_folder(folder.path());
    let artifact = result(&input, &["--channels", "2,3,4"]);
    let metrics: MetricsV2 = artifact.record("/metrics").unwrap().unwrap();
    let of = |channel: &str, name: &str| {
        metrics.metrics.iter().find(|metric| metric.channel == channel && metric.name == name).cloned()
    };
    let crush = of("1+2+3", "dynamic_crush").unwrap();
    let single = |channel: &str| of(channel, "dynamic_crush").unwrap().value;
    // The harder braking stops shorter.
    assert_eq!((crush.low, crush.high, crush.value), (single("2"), single("3"), single("1")));
    assert_eq!(crush.interval_by.as_deref(), Some("range over 3 channels"));
    assert!(crush.definition.ends_with("; value of channel 1"), "{}", crush.definition);
    assert!(of("1+2+3", "olc").is_some_and(|olc| olc.low < olc.value && olc.value < olc.high));
    // The impact speed is one for all.
    assert_eq!(of("1+2+3", "impact_energy"), None);
    let said = notes(&artifact);
    assert!(said.iter().any(|note| note.starts_with("channel 4 is not in the spread")), "{said:?}");
}

#[test]
fn the_barrier_force_is_the_sum_of_its_living_cells_and_its_impulse_is_the_change_of_momentum() {
    let folder = tempfile::tempdir().unwrap();
    let input = test_folder(folder.path());
    let artifact = result(&input, &[]);
    let force = &artifact.waves()["barrier/force"];
    assert_eq!(force.quantity, QuantityKind::Force);
    // 0.6 and 0.4 of 120 kN: rounding only.
    assert!((force.sampled.at(0.05).unwrap() - 120e3).abs() < 1e-6);
    assert!((metric(&artifact, "barrier", "barrier_peak_force").unwrap() - 120e3).abs() < 1e-6);
    // 120 m/s² over 150 ms, ramps of 1 ms at both ends: 18.0 m/s; the pulse has the same samples.
    assert!((metric(&artifact, "barrier", "barrier_delta_v").unwrap() - 18.0).abs() < 1e-9);
    assert!((metric(&artifact, "barrier", "momentum_ratio").unwrap() - 1.0).abs() < 1e-9);
    let said = notes(&artifact);
    assert!(
        said.iter().any(|note| note.contains("1 cell not marked valid by the laboratory, not in the sum: 8")),
        "{said:?}"
    );
    assert!(said.iter().any(|note| note.starts_with("momentum check up to separation at 151.0 ms")), "{said:?}");

    let all = result(&input, &["--barrier-cells", "all"]);
    assert!((metric(&all, "barrier", "momentum_ratio").unwrap() - 1.1).abs() < 1e-9);
    assert!(notes(&all).iter().any(|note| note.starts_with("warning: momentum check")));
    // All cells with data, the dead one among them, whichever are summed: 1.1 of 18 m/s.
    for artifact in [&artifact, &all] {
        assert!((metric(artifact, "barrier", "barrier_delta_v_as_read").unwrap() - 19.8).abs() < 1e-9);
        assert!(notes(artifact).iter().any(|note| note.starts_with("barrier as read: all 3 load cells with data")));
    }
    let none = result(&input, &["--barrier-cells", "none"]);
    assert!(!none.waves().contains_key("barrier/force"));
}

#[test]
fn the_height_of_force_needs_the_heights_of_all_rows() {
    let folder = tempfile::tempdir().unwrap();
    let input = test_folder(folder.path());
    let artifact = result(&input, &["--wall-heights", "6=300mm,7=60cm"]);
    // Rows with 0.6 and 0.4 of the force at every time; the questionable one is not in the sum.
    let height = metric(&artifact, "barrier", "average_height_of_force").unwrap();
    assert!((height - (0.6 * 0.3 + 0.4 * 0.6)).abs() < 1e-9, "{height}");
    let one = result(&input, &["--wall-heights", "6=300mm"]);
    assert_eq!(metric(&one, "barrier", "average_height_of_force"), None);
    assert_eq!(metric(&result(&input, &[]), "barrier", "average_height_of_force"), None);
    assert_eq!(run(&input, &["--wall-heights", "1=300mm"]).status.code(), Some(3));
    assert_eq!(run(&input, &["--wall-heights", "6"]).status.code(), Some(2));
}

#[test]
fn a_stated_end_velocity_is_met_and_what_it_took_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let input = test_folder(folder.path());
    let artifact = result(&input, &["--end-velocity", "-2.5m/s"]);
    let velocity = &artifact.waves()["1/velocity"].sampled;
    assert!((velocity.samples().last().unwrap() + 2.5).abs() < 1e-9);
    // Without it the pulse ends at 15 - 18 = -3 m/s; 0.5 m/s over the record's 249.9 ms.
    assert!((metric(&artifact, "1", "drift_correction").unwrap() + 0.5 / 0.2499).abs() < 1e-6);
    assert!(notes(&artifact).iter().any(|note| note.contains("(-0.20402 g, bias)")), "{:?}", notes(&artifact));

    let artifact = result(&input, &["--end-velocity", "standstill", "--end-time", "120ms", "--drift", "linear"]);
    assert!(artifact.waves()["1/velocity"].sampled.at(0.12).unwrap().abs() < 1e-9);
    assert_eq!(run(&input, &["--end-time", "120ms"]).status.code(), Some(2));
    assert_eq!(run(&input, &["--end-velocity", "-2.5"]).status.code(), Some(2));
    assert_eq!(run(&input, &["--end-velocity", "standstill", "--end-time", "9s"]).status.code(), Some(3));
}

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

fn metric_of_vehicle<'a>(metrics: &'a [MetricV1], channel: &str, name: &str) -> &'a MetricV1 {
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
        let value = |name: &str| metric_of_vehicle(&metrics, "1+4", name).value.unwrap();
        let (crush_m, time_s) = cars.relative_crush();
        // Sums of 10 kHz samples by the trapezoid.
        assert!((value("relative_crush") - crush_m).abs() < 1e-5, "{cars:?}");
        assert!((value("time_of_common_velocity") - time_s).abs() < 1e-6, "{cars:?}");
        assert!((value("common_velocity") - cars.common_velocity_m_per_s()).abs() < 1e-4, "{cars:?}");
        assert!((value("common_velocity_by_momentum") - cars.common_velocity_m_per_s()).abs() < 1e-12, "{cars:?}");
        assert!(value("momentum_gap").abs() < 1e-6 && (value("coefficient_of_restitution") - 1.0).abs() < 1e-4);
        // The second car has its own mass and speed, and its sensors serve nobody else.
        let of_second = |name: &str| metric_of_vehicle(&metrics, "4", name);
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
fn a_vehicle_that_stands_is_reported_with_the_one_that_hits_it() {
    let ahead = TwoVehicles { speeds_km_per_h: [0.0, 50.0], ..TwoVehicles::STANDING };
    let from_behind = TwoVehicles { speeds_km_per_h: [0.0, 50.0], same_heading: true, ..TwoVehicles::STANDING };
    for cars in [ahead, from_behind] {
        let folder = tempfile::tempdir().unwrap();
        let artifact = Artifact::open(&PROGRAM.written(&filtered(folder.path(), &cars), &[])).unwrap();
        let metrics = artifact.record::<MetricsV2>("/metrics").unwrap().unwrap().metrics;
        let value = |name: &str| metric_of_vehicle(&metrics, "1+4", name).value.unwrap();
        let common = cars.masses_kg[1] * 50.0 / 3.6 / (cars.masses_kg[0] + cars.masses_kg[1]);
        assert!((value("common_velocity").abs() - common).abs() < 1e-4, "{cars:?}");
        assert!((value("common_velocity_by_momentum").abs() - common).abs() < 1e-12, "{cars:?}");
        assert!(value("momentum_gap").abs() < 1e-6 && value("relative_crush") > 0.1, "{cars:?}");
        assert!(artifact.waves().contains_key("4/velocity") && artifact.waves().contains_key("1/velocity"));
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

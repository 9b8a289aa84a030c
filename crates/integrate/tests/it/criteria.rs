//! The program on tests with occupants and a centre of gravity, on pulses from rest and of the wrong sign.

use std::io::Read;
use std::path::{Path, PathBuf};

use crumple_artifact::records::{
    ChannelFilterV1, DamageV1, DiagnosisV1, EventsV1, MetricV1, MetricsV2, NotesV1, TestV1,
};
use crumple_artifact::{Artifact, ArtifactBuilder, Compression, Provenance};
use crumple_integrate::{impulse_n_s, sum_of_cells};
use crumple_signal::{Axis, Channel, QuantityKind, STANDARD_GRAVITY_M_PER_S2, Sampled, TestDescription};
use crumple_testkit::write_filtered;

use crate::{PROGRAM, result};

fn channel(id: &str, location: &str, axis: Axis, cfc: u16) -> Channel {
    Channel {
        location: location.to_owned(),
        axis: Some(axis),
        cfc: Some(cfc),
        ..Channel::new(id, QuantityKind::Acceleration)
    }
}

/// `level` from time zero on for `length_s`, 50 ms at rest before it.
fn square(level: f64, length_s: f64) -> Sampled {
    let at = |t: f64| if (0.0..length_s - 1e-9).contains(&t) { level } else { 0.0 };
    Sampled::new(-0.05, 1e-4, (0..3001).map(|k| at((f64::from(k) - 500.0) * 1e-4)).collect()).unwrap()
}

fn filtered(folder: &Path, waves: &[(Channel, Sampled)], impact_speed_m_per_s: Option<f64>) -> PathBuf {
    let test = TestDescription {
        title: "criteria".to_owned(),
        mass_kg: Some(1500.0),
        impact_speed_m_per_s,
        ..TestDescription::default()
    };
    let channels: Vec<_> = waves.iter().map(|(channel, wave)| (channel.clone(), Some(wave.clone()))).collect();
    write_filtered(folder, test, &channels).unwrap()
}

fn metrics(artifact: &Artifact) -> Vec<MetricV1> {
    artifact.record::<MetricsV2>("/metrics").unwrap().unwrap().metrics
}

fn notes(artifact: &Artifact) -> Vec<String> {
    artifact.record::<NotesV1>("/notes").unwrap().map(|notes| notes.notes).unwrap_or_default()
}

fn find<'a>(metrics: &'a [MetricV1], channel: &str, name: &str) -> &'a MetricV1 {
    let found = metrics.iter().find(|metric| metric.channel == channel && metric.name == name);
    found.unwrap_or_else(|| panic!("no {name} of {channel}"))
}

fn complete(metrics: &[MetricV1]) {
    for metric in metrics {
        assert!(metric.definition_id.is_some(), "{metric:?}");
        assert_eq!(metric.value.is_some(), metric.from_s.is_some() && metric.to_s.is_some(), "{metric:?}");
    }
}

fn occupants() -> Vec<(Channel, Sampled)> {
    let g = STANDARD_GRAVITY_M_PER_S2;
    vec![
        (channel("p", "vehicle, left sill", Axis::X, 60), square(-200.0, 0.1)),
        (channel("hx", "driver, head", Axis::X, 1000), square(-20.0 * g, 0.05)),
        (channel("hy", "driver, head", Axis::Y, 1000), square(30.0 * g, 0.05)),
        (channel("hz", "driver, head", Axis::Z, 1000), square(60.0 * g, 0.05)),
        (channel("cx", "driver, chest", Axis::X, 180), square(-200.0, 0.1)),
        (channel("fx", "front passenger, head", Axis::X, 60), square(-70.0 * g, 0.05)),
    ]
}

#[test]
fn heads_and_chests_get_their_criteria_with_id_unit_and_window() {
    let folder = tempfile::tempdir().unwrap();
    let artifact = result(&filtered(folder.path(), &occupants(), Some(20.0)), &[]);
    let metrics = metrics(&artifact);
    complete(&metrics);
    // The resultant is 70 g: sqrt(400 + 900 + 3600). A square: 70^2.5 times the window.
    for (name, window_s, id) in [("hic15", 0.015, "hic15-fmvss208"), ("hic36", 0.036, "hic36-fmvss208")] {
        let hic = find(&metrics, "hx+hy+hz", name);
        assert!((hic.value.unwrap() / (70.0_f64.powf(2.5) * window_s) - 1.0).abs() < 1e-9, "{hic:?}");
        assert_eq!((hic.definition_id.as_deref(), hic.unit.as_str()), (Some(id), "1"));
        assert!((hic.to_s.unwrap() - hic.from_s.unwrap() - window_s).abs() < 1e-9 && hic.from_s.unwrap() > -1e-4);
        assert!(!hic.definition.contains("cfc"), "{}", hic.definition);
    }
    for name in ["clip_3ms_contiguous", "clip_3ms_cumulative"] {
        let clip = find(&metrics, "hx+hy+hz", name).value.unwrap();
        assert!((clip / (70.0 * STANDARD_GRAVITY_M_PER_S2) - 1.0).abs() < 1e-9, "{clip}");
        assert!((find(&metrics, "cx", name).value.unwrap() - 200.0).abs() < 1e-9);
    }
    assert!(!metrics.iter().any(|metric| metric.name == "hic_d"), "no free-motion headform here");
    // One axis at another class: a lower bound, and the class is said.
    let alone = find(&metrics, "fx", "hic15");
    assert!(alone.definition.contains("lower bound: resultant of x alone"), "{}", alone.definition);
    assert!(alone.definition.contains("is of CFC 60, the definition asks for CFC 1000"), "{}", alone.definition);
    let notes = notes(&artifact);
    assert!(notes.iter().any(|note| note.starts_with("warning: front passenger, head: channel fx")), "{notes:?}");
    // A chest that moves with the vehicle: everything is ridden down, nothing is left to the restraint.
    // The step of one sample makes the velocity jump by 0.01 m/s late, of 20 m/s.
    assert!((find(&metrics, "cx", "ride_down_efficiency").value.unwrap() - 1.0).abs() < 2e-3);
    assert!(find(&metrics, "cx", "restraint_energy_ratio").value.unwrap().abs() < 1e-9);

    let none = result(&filtered(folder.path(), &occupants(), Some(20.0)), &["--metrics", "none"]);
    assert!(!self::metrics(&none).iter().any(|metric| metric.name.starts_with("hic")));
    let chest = result(&filtered(folder.path(), &occupants(), Some(20.0)), &["--metrics", "chest"]);
    assert!(!self::metrics(&chest).iter().any(|metric| metric.name.starts_with("hic")));
    find(&self::metrics(&chest), "cx", "clip_3ms_cumulative");
}

#[test]
fn a_free_motion_headform_has_hic_d_and_a_head_without_impact_speed_keeps_its_criteria() {
    let folder = tempfile::tempdir().unwrap();
    let headform = [(channel("r", "headform", Axis::Resultant, 1000), square(60.0 * STANDARD_GRAVITY_M_PER_S2, 0.02))];
    let input = filtered(folder.path(), &headform, None);
    // Nobody needs an impact speed for them, the second time either; later stages are told that there is no motion.
    for _ in 0..2 {
        assert_eq!(PROGRAM.run(&input, &[]).status.code(), Some(0));
    }
    let artifact = Artifact::open(&input.with_file_name("3-integrate.mcap")).unwrap();
    let diagnosis: DiagnosisV1 = artifact.record("/diagnosis").unwrap().unwrap();
    assert!(diagnosis.has_result && diagnosis.reason.starts_with("criteria of occupants alone"), "{diagnosis:?}");
    let hic_d = find(&metrics(&artifact), "r", "hic_d").value.unwrap();
    // 20 ms of 60 g; the flanks of the trapezoid add half a sample on either side, which the mean loses again.
    let exact = 0.75446 * 60.0_f64.powf(2.5) * 0.02 + 166.4;
    assert!((hic_d / exact - 1.0).abs() < 5e-3, "{hic_d} {exact}");
}

#[test]
fn a_pulse_of_an_occupant_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let input = filtered(folder.path(), &occupants(), Some(20.0));
    for flags in [&["--channel", "cx"], &["--channels", "cx"]] {
        let notes = notes(&result(&input, flags));
        let warned = |note: &String| note.starts_with("warning: channel cx is not of the vehicle (driver, chest)");
        assert!(notes.iter().any(warned), "{notes:?}");
    }
    assert!(!notes(&result(&input, &[])).iter().any(|note| note.contains("not of the vehicle")));
}

#[test]
fn x_y_and_yaw_at_the_centre_of_gravity_get_the_roadside_metrics() {
    let folder = tempfile::tempdir().unwrap();
    let mut waves = vec![
        (channel("x", "vehicle, centre of gravity", Axis::X, 180), square(-200.0, 0.25)),
        (channel("y", "vehicle, centre of gravity", Axis::Y, 180), square(0.0, 0.25)),
    ];
    let input = filtered(folder.path(), &waves, Some(30.0));
    let found = metrics(&result(&input, &[]));
    complete(&found);
    // Free flight of 0.6 m: sqrt(2·0.6·200); interpolating in position errs by a part of a sample.
    let flight = (1.2_f64 * 200.0).sqrt();
    assert!((find(&found, "x+y", "oiv_x").value.unwrap() - flight).abs() < 1e-3);
    assert!((find(&found, "x+y", "ora_x").value.unwrap() - 200.0).abs() < 1e-6);
    assert_eq!(find(&found, "x+y", "asi").definition_id.as_deref(), Some("asi-en1317-2010"));
    assert_eq!(find(&found, "x+y", "thiv").definition, "absent: no yaw rate of the vehicle is measured");

    let rate = Channel { quantity: QuantityKind::AngularVelocity, ..channel("w", "vehicle, floor", Axis::Z, 180) };
    waves.push((rate, square(0.0, 0.25)));
    let input = filtered(folder.path(), &waves, Some(30.0));
    let found = metrics(&result(&input, &[]));
    assert!((find(&found, "x+y+w", "thiv").value.unwrap() - flight).abs() < 1e-3);
    assert!((find(&found, "x+y+w", "phd").value.unwrap() - 200.0).abs() < 1e-6);

    // Without a centre of gravity only on request, and it is said.
    let input = filtered(folder.path(), &occupants(), Some(20.0));
    assert!(!metrics(&result(&input, &[])).iter().any(|metric| metric.name == "asi"));
    let asked = result(&input, &["--metrics", "roadside"]);
    let asi = find(&metrics(&asked), "p", "asi").definition.clone();
    assert!(asi.contains("taken as 0") && asi.contains("asks for CFC 180"), "{asi}");
    for name in ["oiv_y", "ora_y"] {
        let found = metrics(&asked);
        let across = find(&found, "p", name);
        assert_eq!(
            (across.value, across.definition.as_str()),
            (None, "absent: y is not measured at the centre of gravity")
        );
    }
}

#[test]
fn what_was_measured_and_left_out_by_the_filter_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let waves = [
        (channel("x", "vehicle, centre of gravity", Axis::X, 180), square(-200.0, 0.25)),
        (channel("y", "vehicle, centre of gravity", Axis::Y, 180), square(0.0, 0.25)),
    ];
    let input = filtered(folder.path(), &waves, Some(30.0));
    let read = Artifact::open(&input).unwrap();
    let mut test: TestDescription = read.record::<TestV1>("/test").unwrap().unwrap().try_into().unwrap();
    test.channels.extend([
        channel("1", "driver, head", Axis::X, 1000),
        channel("2", "driver, head", Axis::Y, 1000),
        Channel { quantity: QuantityKind::AngularVelocity, ..channel("w", "vehicle, floor", Axis::Z, 180) },
    ]);
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &TestV1::from(&test)).unwrap();
    for (id, wave) in read.waves() {
        builder.wave(id, wave.quantity, wave.sampled.clone()).unwrap();
    }
    builder.write(&input, &Provenance::new("filter", "0", "{}".to_owned(), vec![]), Compression::None).unwrap();
    let artifact = result(&input, &["--metrics", "head,chest,roadside"]);
    let thiv = find(&metrics(&artifact), "x+y", "thiv").definition.clone();
    assert_eq!(thiv, "absent: channel w measured the yaw rate, but the filter left it out");
    let said = notes(&artifact).join("\n");
    for text in [
        "warning: head: channels 1, 2 measured it, but the filter left it out: without channels it takes all, or --set \
         filter.channels='x,1,2'",
        "warning: chest: no accelerometer of it has data in the inputs",
        "thiv: channel w measured the yaw rate, but the filter left it out: --set filter.pass hands it on",
    ] {
        assert!(said.contains(text), "{said}");
    }
}

#[test]
fn width_and_residual_crush_give_the_stiffness_of_crash3() {
    let folder = tempfile::tempdir().unwrap();
    let input = filtered(folder.path(), &occupants(), Some(20.0));
    let flags = ["--damage-width", "1.5m", "--residual-crush", "500mm", "--no-damage-speed", "2m/s"];
    let found = metrics(&result(&input, &flags));
    complete(&found);
    // b1 = (20 - 2)/0.5 = 36 1/s; A = 1500·2·36/1.5, B = 1500·36²/1.5, G = 1500·2²/(2·1.5).
    for (name, exact) in [("crush_stiffness_a", 72e3), ("crush_stiffness_b", 1.296e6), ("crush_stiffness_g", 2000.0)] {
        assert!((find(&found, "p", name).value.unwrap() / exact - 1.0).abs() < 1e-12);
    }
    assert_eq!(PROGRAM.run(&input, &["--damage-width", "1.5m"]).status.code(), Some(2));
}

/// The damage that a file states, handed on by the filter, beside the artifact that is made here.
#[test]
fn a_stated_crush_profile_gives_the_energy_of_the_test_back() {
    let folder = tempfile::tempdir().unwrap();
    let damage = |classification: &str, width: Option<f64>| DamageV1 {
        residual_crush_m: vec![0.3, 0.5, 0.6, 0.6, 0.4, -0.05],
        damage_width_m: None,
        vehicle_width_m: width,
        classification: Some(classification.to_owned()),
        from: "DPD1-DPD6".to_owned(),
    };
    let stated = |damage: &DamageV1| {
        let input = filtered(folder.path(), &occupants(), Some(20.0));
        let artifact = Artifact::open(&input).unwrap();
        let mut builder = ArtifactBuilder::new();
        builder.put("/test", &artifact.record::<TestV1>("/test").unwrap().unwrap()).unwrap();
        builder.put("/damage", damage).unwrap();
        for (id, wave) in artifact.waves() {
            builder.wave(id, wave.quantity, wave.sampled.clone()).unwrap();
        }
        let provenance = Provenance::new("filter", "0", "{}".to_owned(), vec![]);
        builder.write(&input, &provenance, Compression::None).unwrap();
        metrics(&result(&input, &["--force"]))
    };
    let found = stated(&damage("12FDEW2", Some(1.8)));
    // 1500 kg at 20 m/s.
    assert!((find(&found, "p", "crush_energy").value.unwrap() / 3e5 - 1.0).abs() < 1e-12);
    assert!(find(&found, "p", "crush_stiffness_a").definition.contains("width 1.8 m of the vehicle"));
    for none in [damage("03RDEW2", Some(1.8)), damage("12FDEW2", None)] {
        assert!(!stated(&none).iter().any(|metric| metric.name == "crush_stiffness_a"));
    }
}

#[test]
fn a_motion_from_rest_has_velocity_and_displacement_and_no_events() {
    let folder = tempfile::tempdir().unwrap();
    let waves = [(channel("p", "", Axis::X, 60), square(100.0, 0.1))];
    let artifact = result(&filtered(folder.path(), &waves, None), &["--impact-speed", "0m/s"]);
    let velocity = &artifact.waves()["p/velocity"].sampled;
    // 100 m/s² over 0.1 s; both flanks are ramps of one sample.
    assert!((velocity.samples().last().unwrap() - 10.0).abs() < 1e-9);
    assert!(artifact.waves().contains_key("p/displacement"));
    assert_eq!(artifact.record::<EventsV1>("/events").unwrap(), None);
    let notes = notes(&artifact);
    assert!(!notes.iter().any(|note| note.contains("polarity") || note.contains("wrong sign")), "{notes:?}");
    let metrics = metrics(&artifact);
    complete(&metrics);
    assert_eq!(find(&metrics, "p", "dynamic_crush").definition, "absent: the motion starts from rest");
    // 100 m/s² over 0.1 s from rest: 0.5 m, and a flank of half a sample.
    assert!((find(&metrics, "p", "stroke").value.unwrap() - 0.5).abs() < 1e-3);

    let input = filtered(folder.path(), &waves, None);
    let output = PROGRAM.run(&input, &["--impact-speed=-5m/s"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(
        stderr.contains("--impact-speed 0m/s is right for a motion from rest") && !stderr.contains("--time-zero"),
        "{stderr}"
    );
}

#[test]
fn a_pulse_of_the_wrong_sign_is_said_first_and_has_no_crush() {
    let folder = tempfile::tempdir().unwrap();
    // Drifts back through zero long after it has doubled the velocity: no crush either.
    let mut samples = square(200.0, 0.1).into_samples();
    samples[1600..].fill(-600.0);
    let waves = [(channel("p", "", Axis::X, 60), Sampled::new(-0.05, 1e-4, samples).unwrap())];
    let artifact = result(&filtered(folder.path(), &waves, Some(15.0)), &["--speed-uncertainty", "0.1km/h"]);
    let notes = notes(&artifact);
    assert!(notes[0].starts_with("warning: the pulse has the wrong sign: --sign flip at ingest"), "{notes:?}");
    let events: EventsV1 = artifact.record("/events").unwrap().unwrap();
    assert_eq!((events.dynamic_crush_m, events.rebound_velocity_m_per_s), (None, None));
    assert!(events.intervals.is_empty());
}

#[test]
fn every_metric_has_an_id_and_every_value_a_window() {
    // What the stage makes of a drift, several channels and a barrier.
    let folder = tempfile::tempdir().unwrap();
    let mut waves = occupants();
    waves.push((channel("q", "vehicle, right sill", Axis::X, 60), square(-210.0, 0.1)));
    let force = Channel { quantity: QuantityKind::Force, ..channel("b", "barrier, load cell A", Axis::X, 60) };
    waves.push((force, square(-300_000.0, 0.1)));
    let input = filtered(folder.path(), &waves, Some(20.0));
    let flags = ["--channels", "all", "--end-velocity", "-0.1m/s", "--gain-uncertainty", "1%"];
    let found = metrics(&result(&input, &flags));
    for name in ["drift_correction", "barrier_peak_force", "barrier_delta_v_as_read", "momentum_ratio", "hic15"] {
        assert!(found.iter().any(|metric| metric.name == name && metric.value.is_some()), "{name}");
    }
    complete(&found);
}

#[test]
fn the_barrier_as_read_has_the_zero_level_that_the_filter_removed() {
    let folder = tempfile::tempdir().unwrap();
    let force = Channel { quantity: QuantityKind::Force, ..channel("b", "barrier, load cell A", Axis::X, 60) };
    let waves = [(channel("p", "vehicle", Axis::X, 60), square(-200.0, 0.1)), (force, square(-300_000.0, 0.1))];
    let input = filtered(folder.path(), &waves, Some(20.0));
    let without = metrics(&result(&input, &[]));
    assert_eq!(
        find(&without, "barrier", "barrier_delta_v_as_read").value,
        find(&without, "barrier", "barrier_delta_v").value
    );
    let mut builder = ArtifactBuilder::new();
    let filter = serde_json::json!({
        "cfc": 60, "mode": "iso6487", "samples_added": 0, "coefficients": [], "zero_level_removed": 600.0, "notes": []
    });
    let read = Artifact::open(&input).unwrap();
    builder.put("/test", &read.record::<TestV1>("/test").unwrap().unwrap()).unwrap();
    builder.put("/filter/b", &serde_json::from_value::<ChannelFilterV1>(filter).unwrap()).unwrap();
    for (id, wave) in read.waves() {
        builder.wave(id, wave.quantity, wave.sampled.clone()).unwrap();
    }
    builder.write(&input, &Provenance::new("filter", "0", "{}".to_owned(), vec![]), Compression::None).unwrap();
    let found = metrics(&result(&input, &["--force"]));
    let gap = find(&found, "barrier", "barrier_delta_v").value.unwrap()
        - find(&found, "barrier", "barrier_delta_v_as_read").value.unwrap();
    // 600 N for the 250 ms after time zero, against the sign of compression, over 1500 kg.
    assert!((gap - 600.0 * 0.25 / 1500.0).abs() < 1e-9, "{gap}");
}

const MASS_KG: f64 = 1719.0;
/// Marked failed by the laboratory.
const FAILED: [&str; 2] = ["347", "500"];

/// Curve number and force of every cell, as read.
fn cells() -> Option<Vec<(String, Sampled)>> {
    let path = crumple_testkit::shared("data/nhtsa-v10146-camry-frontal/v10146_barrier_fx.zip")?;
    let mut archive = zip::ZipArchive::new(std::fs::File::open(path).unwrap()).unwrap();
    let cells = (0..archive.len()).map(|k| {
        let mut file = archive.by_index(k).unwrap();
        let (mut text, id) = (String::new(), file.name().unwrap().rsplit_once('.').unwrap().1.to_owned());
        file.read_to_string(&mut text).unwrap();
        let column = text.lines().map(|line| line.split_once('\t').unwrap().1.trim().parse().unwrap()).collect();
        (id, Sampled::new(-0.05, 1e-4, column).unwrap())
    });
    Some(cells.collect())
}

fn delta_v_km_per_h(cells: &[(String, Sampled)], left_out: &[&str]) -> f64 {
    let taken: Vec<(&str, &Sampled)> = cells
        .iter()
        .filter(|(id, _)| !left_out.contains(&id.as_str()))
        .map(|(id, samples)| (id.as_str(), samples))
        .collect();
    let sum = sum_of_cells(&taken).unwrap().unwrap();
    assert_eq!((sum.cells, sum.turned), (taken.len(), true), "this laboratory reads compression as negative");
    3.6 * impulse_n_s(&sum.force, 0.0, sum.force.end_s()).unwrap() / MASS_KG
}

#[test]
fn the_impulse_over_the_mass_is_68_km_per_h_with_all_cells_and_without_the_dead_ones() {
    let Some(cells) = cells() else { return };
    assert_eq!(cells.len(), 176);
    // Published as 68.0 km/h: half a unit of the last digit.
    assert!((delta_v_km_per_h(&cells, &[]) - 68.0).abs() < 0.05, "{}", delta_v_km_per_h(&cells, &[]));
    // The two dead cells read noise around zero.
    assert!((delta_v_km_per_h(&cells, &FAILED) - 68.0).abs() < 0.05, "{}", delta_v_km_per_h(&cells, &FAILED));
    println!(
        "{:.3} km/h, without the dead cells {:.3}",
        delta_v_km_per_h(&cells, &[]),
        delta_v_km_per_h(&cells, &FAILED)
    );
}

#[test]
fn the_impulse_agrees_with_the_accelerometers_within_three_percent() {
    let Some(cells) = cells() else { return };
    let of_barrier = delta_v_km_per_h(&cells, &[]);
    // Largest change of velocity of the four rear-seat channels, as published with the record.
    for of_sensor in [66.2, 67.0, 67.5, 66.8] {
        // 3 % is what the publisher of the record states for the agreement.
        assert!((of_barrier / of_sensor - 1.0).abs() < 0.03, "{of_barrier} {of_sensor}");
    }
}

//! The program on records that are no plain full-width frontal crash: a vehicle that does not stop, a recorder without
//! a speed, heads without a vehicle, sensors of unknown place.

use std::path::{Path, PathBuf};

use crumple_artifact::Artifact;
use crumple_artifact::records::{DiagnosisV1, EventsV1, MetricV1, MetricsV2, NotesV1};
use crumple_signal::{Axis, Channel, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G, Sampled, TestDescription};
use crumple_testkit::program::Program;
use crumple_testkit::write_filtered;

const PROGRAM: Program = Program { exe: env!("CARGO_BIN_EXE_crumple-integrate"), output: "3-integrate.mcap" };

fn accelerometer(id: &str, axis: Axis, cfc: u16) -> Channel {
    Channel { axis: Some(axis), cfc: Some(cfc), ..Channel::new(id, QuantityKind::Acceleration) }
}

/// Half sine of `peak` over `length_s` from `from_s` on, 50 ms at rest before time zero; ends at `end_s`.
fn half_sine(peak: f64, from_s: f64, length_s: f64, end_s: f64) -> Sampled {
    let at = |t: f64| {
        let share = (t - from_s) / length_s;
        if (0.0..=1.0).contains(&share) { peak * (std::f64::consts::PI * share).sin() } else { 0.0 }
    };
    let samples = ((0.05 + end_s) * 1e4).round() as i32;
    Sampled::new(-0.05, 1e-4, (0..=samples).map(|k| at(f64::from(k) * 1e-4 - 0.05)).collect()).unwrap()
}

/// Written as the filter would have, without a mass.
fn filtered(folder: &Path, channels: &[(Channel, Option<Sampled>)], impact_speed_m_per_s: Option<f64>) -> PathBuf {
    let test = TestDescription { title: "unusual".to_owned(), impact_speed_m_per_s, ..TestDescription::default() };
    write_filtered(folder, test, channels).unwrap()
}

fn result(input: &Path, flags: &[&str]) -> Artifact {
    Artifact::open(&PROGRAM.written(input, flags)).unwrap()
}

fn events(artifact: &Artifact) -> EventsV1 {
    artifact.record("/events").unwrap().unwrap()
}

fn metrics(artifact: &Artifact) -> Vec<MetricV1> {
    artifact.record::<MetricsV2>("/metrics").unwrap().map(|record| record.metrics).unwrap_or_default()
}

fn find(metrics: &[MetricV1], channel: &str, name: &str) -> MetricV1 {
    let found = metrics.iter().find(|metric| metric.channel == channel && metric.name == name);
    found.unwrap_or_else(|| panic!("no {name} of {channel}")).clone()
}

fn notes(artifact: &Artifact) -> String {
    artifact.record::<NotesV1>("/notes").unwrap().map(|notes| notes.notes.join("\n")).unwrap_or_default()
}

#[test]
fn a_vehicle_that_does_not_stop_has_its_delta_v_and_the_end_of_its_event() {
    let folder = tempfile::tempdir().unwrap();
    // 2·A·D/π = 10.19 m/s of 15 m/s.
    let (peak, length_s) = (160.0, 0.1);
    let change = 2.0 * peak * length_s / std::f64::consts::PI;
    let pulse = half_sine(-peak, 0.0, length_s, 0.3);
    let input = filtered(folder.path(), &[(accelerometer("p", Axis::X, 60), Some(pulse))], Some(15.0));
    let artifact = result(&input, &["--gain-uncertainty", "1% uniform"]);
    let found = events(&artifact);
    assert_eq!((found.dynamic_crush_m, found.time_of_rebound_s), (None, None));
    // The trapezoid of a half sine errs by (πT/D)²/12: 8e-7 of it.
    assert!((found.delta_v_m_per_s.unwrap() / change - 1.0).abs() < 1e-6, "{found:?}");
    // Of the samples of a sum that ends flat the lowest may be a few before the end.
    assert!((found.time_of_delta_v_s.unwrap() - length_s).abs() < 1e-3, "{found:?}");
    // The 20 ms with 0.2222 m/s begin at t with (1 + cos(πt/D))·A·D/π = 0.2222.
    let quiet = length_s / std::f64::consts::PI * ((0.8 / 3.6) * std::f64::consts::PI / (peak * length_s) - 1.0).acos();
    assert!((found.end_of_event_s.unwrap() - quiet - 0.02).abs() < 1.1e-4, "{found:?} {quiet}");
    assert_eq!(found.end_of_event_rule.as_deref(), Some("20 ms with no more than 0.8 km/h (49 CFR 563)"));
    // A percent of gain is a percent of the change.
    let interval = found.intervals.iter().find(|interval| interval.name == "delta_v_m_per_s").unwrap();
    assert!((interval.high / change - 1.009).abs() < 5e-4, "{interval:?}");
    let metric = find(&metrics(&artifact), "p", "delta_v");
    assert!(metric.definition.contains("never reaches zero, the event ends at"), "{}", metric.definition);
    assert!(
        notes(&artifact).contains("no dynamic crush, no rebound; delta-v is 10.186 m/s at"),
        "{}",
        notes(&artifact)
    );

    let cut = half_sine(-peak, 0.0, length_s, 0.06);
    let input = filtered(folder.path(), &[(accelerometer("p", Axis::X, 60), Some(cut))], Some(15.0));
    let artifact = result(&input, &["--force"]);
    assert_eq!(events(&artifact).end_of_event_rule.as_deref(), Some("end of the record"));
    assert!(notes(&artifact).contains("a lower bound, it still changes there"), "{}", notes(&artifact));
}

#[test]
fn an_interval_that_cannot_be_says_why() {
    let folder = tempfile::tempdir().unwrap();
    // The pulse takes 15.28 m/s: at 15.2 m/s some replicates do not stop.
    let pulse = half_sine(-240.0, 0.0, 0.1, 0.15);
    let input = filtered(folder.path(), &[(accelerometer("p", Axis::X, 60), Some(pulse))], Some(15.2));
    let artifact = result(&input, &["--speed-uncertainty", "0.3 m/s uniform"]);
    let found = events(&artifact);
    assert!(
        found.dynamic_crush_m.is_some() && found.intervals.iter().all(|i| i.name != "dynamic_crush_m"),
        "{found:?}"
    );
    let without = found.without_interval.iter().find(|without| without.name == "dynamic_crush_m").unwrap();
    let said = "of 400 replicates with perturbed inputs do not have it";
    assert!(without.reason.starts_with("no interval: ") && without.reason.ends_with(said), "{without:?}");
    let metric = find(&metrics(&artifact), "p", "dynamic_crush");
    assert_eq!((metric.low, metric.interval_by.as_deref()), (None, Some(without.reason.as_str())));
    assert_eq!(find(&metrics(&artifact), "p", "energy_closure").interval_by, None);
    // The peak is in all of them.
    assert!(find(&metrics(&artifact), "p", "peak_acceleration").low.is_some());
}

#[test]
fn a_recorder_without_a_speed_has_its_maximum_delta_v() {
    let folder = tempfile::tempdir().unwrap();
    let km_per_h = [0, -4, -11, -20, -31, -40, -46, -49, -50, -50, -49, -49];
    let change = Sampled::new(0.0, 0.01, km_per_h.iter().map(|v| f64::from(*v) / 3.6).collect()).unwrap();
    let acceleration = Sampled::new(0.0, 0.01, vec![-100.0; 12]).unwrap();
    let lateral = Sampled::new(0.0, 0.01, vec![0.0, 1.0, 2.0]).unwrap();
    let channels = [
        (accelerometer("dv_derivative", Axis::X, 60), Some(acceleration)),
        (Channel::new("across", QuantityKind::VelocityChange), Some(lateral)),
        (Channel::new("dv", QuantityKind::VelocityChange), Some(change)),
    ];
    let input = filtered(folder.path(), &channels, None);
    for _ in 0..2 {
        assert_eq!(PROGRAM.run(&input, &[]).status.code(), Some(0));
    }
    let artifact = result(&input, &[]);
    let found = find(&metrics(&artifact), "dv", "maximum_delta_v");
    // 50 km/h; rounding of the division only.
    assert!((found.value.unwrap() + 50.0 / 3.6).abs() < 1e-12, "{found:?}");
    assert!((find(&metrics(&artifact), "dv", "time_of_maximum_delta_v").value.unwrap() - 0.08).abs() < 1e-12);
    assert_eq!(metrics(&artifact)[0].channel, "dv", "what the pulse is made of comes first");
    let diagnosis: DiagnosisV1 = artifact.record("/diagnosis").unwrap().unwrap();
    assert!(diagnosis.has_result && diagnosis.reason.contains("no impact speed"), "{diagnosis:?}");
    // With one it is there beside the motion.
    let input = filtered(folder.path(), &channels, Some(20.0));
    let artifact = result(&input, &["--force"]);
    assert!(events(&artifact).delta_v_m_per_s.is_some());
    find(&metrics(&artifact), "dv", "maximum_delta_v");
}

#[test]
fn a_vehicle_without_a_speed_has_its_change_of_velocity_beside_what_its_dummies_measured() {
    let folder = tempfile::tempdir().unwrap();
    let channels = [
        (accelerometer("p", Axis::X, 60), Some(half_sine(-200.0, 0.0, 0.1, 0.2))),
        (accelerometer("head_x_g", Axis::X, 1000), Some(half_sine(-60.0 * G, 0.03, 0.05, 0.2))),
    ];
    let input = filtered(folder.path(), &channels, None);
    let artifact = result(&input, &[]);
    assert!(find(&metrics(&artifact), "head_x_g", "hic15").value.is_some());
    assert!(find(&metrics(&artifact), "p", "delta_v").value.is_some());
    let diagnosis: DiagnosisV1 = artifact.record("/diagnosis").unwrap().unwrap();
    assert!(diagnosis.has_result && diagnosis.reason.contains("no impact speed"), "{diagnosis:?}");
}

#[test]
fn columns_of_one_head_are_one_resultant_and_no_twin_of_the_vehicle() {
    let folder = tempfile::tempdir().unwrap();
    let mut channels = vec![(accelerometer("sill_x_g", Axis::X, 60), Some(half_sine(-250.0, 0.0, 0.1, 0.2)))];
    for (id, axis, peak) in [("head_x_g", Axis::X, 20.0), ("head_y_g", Axis::Y, 30.0), ("head_z_g", Axis::Z, 60.0)] {
        channels.push((accelerometer(id, axis, 1000), Some(half_sine(-peak * G, 0.03, 0.06, 0.2))));
    }
    let input = filtered(folder.path(), &channels, Some(14.0));
    let artifact = result(&input, &["--channels", "all"]);
    let hic = find(&metrics(&artifact), "head_x_g+head_y_g+head_z_g", "hic15");
    // A half sine of 70 g: sqrt(400 + 900 + 3600). 15 ms about its peak of 60 ms are less than 70^2.5 times the window
    // by 5 %.
    let flat = 70.0_f64.powf(2.5) * 0.015;
    assert!((0.9..1.0).contains(&(hic.value.unwrap() / flat)), "{hic:?} {flat}");
    assert!(!hic.definition.contains("lower bound"), "{}", hic.definition);
    assert!(!artifact.waves().contains_key("head_x_g/displacement"));
    assert!(!metrics(&artifact).iter().any(|metric| metric.channel.contains("sill_x_g+")), "no spread with a head");
}

#[test]
fn a_filter_that_left_the_pulse_out_leaves_the_criteria() {
    let folder = tempfile::tempdir().unwrap();
    let head = (accelerometer("head_x_g", Axis::X, 1000), Some(half_sine(-60.0 * G, 0.03, 0.05, 0.2)));
    let input = filtered(folder.path(), &[(accelerometer("p", Axis::X, 60), None), head], Some(14.0));
    let artifact = result(&input, &[]);
    assert!(find(&metrics(&artifact), "head_x_g", "hic15").value.is_some());
    let diagnosis: DiagnosisV1 = artifact.record("/diagnosis").unwrap().unwrap();
    assert!(diagnosis.reason.contains("the pulse p is not in the inputs"), "{diagnosis:?}");

    // Another part of the vehicle has no criteria: the program is named that left the pulse out.
    let engine = (accelerometer("engine", Axis::X, 60), Some(half_sine(-300.0, 0.0, 0.05, 0.2)));
    let input = filtered(folder.path(), &[(accelerometer("p", Axis::X, 60), None), engine], Some(14.0));
    let output = PROGRAM.run(&input, &[]);
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(
        text.contains("hint: crumple-filter --channels leaves out what it does not name: name p there too"),
        "{text}"
    );
}

#[test]
fn a_sensor_of_unknown_place_that_moves_otherwise_is_not_held_against_the_vehicle_unless_named() {
    let folder = tempfile::tempdir().unwrap();
    let channels = [
        (accelerometer("a", Axis::X, 60), Some(half_sine(-250.0, 0.0, 0.1, 0.2))),
        (accelerometer("b", Axis::X, 60), Some(half_sine(-252.0, 0.0, 0.1, 0.2))),
        (accelerometer("c", Axis::X, 60), Some(half_sine(-600.0, 0.03, 0.05, 0.2))),
    ];
    let input = filtered(folder.path(), &channels, Some(14.0));
    let artifact = result(&input, &["--channels", "all"]);
    let motions: Vec<_> =
        ["a", "b", "c"].map(|id| artifact.waves().contains_key(&format!("{id}/displacement"))).to_vec();
    assert_eq!(motions, [true, true, false]);
    assert!(
        notes(&artifact).contains("warning: channel c does not move as the pulse does, and nothing says where it sits")
    );
    find(&metrics(&artifact), "a+b", "dynamic_crush");
    let artifact = result(&input, &["--channels", "all,c", "--force"]);
    assert!(artifact.waves().contains_key("c/displacement"));

    let asked = result(&input, &["--metrics", "head", "--force"]);
    assert!(notes(&asked).contains("nothing says where channels a, b, c sit"), "{}", notes(&asked));
    // What a pipeline names and the record has not: what it has, and the key.
    let output = PROGRAM.run(&input, &["--channels", "all,95"]);
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3));
    for said in ["no channel \"95\"", "channels of [integrate]", "inputs: a, b, c", "sensors of [parameter-solve]"] {
        assert!(text.contains(said), "{said}: {text}");
    }
}

//! Sleds, pushed vehicles and motions from rest: what is known of them, and that nothing is modelled.

use std::path::{Path, PathBuf};

use crumple_artifact::Artifact;
use crumple_artifact::records::{EventsV1, MetricV1, MetricsV2, NotesV1};
use crumple_signal::{Axis, Channel, KindOfTest, QuantityKind, Sampled, TestDescription, TestKind};
use crumple_testkit::write_filtered;

use crate::{result, run};

/// Half sine of `peak` over 100 ms with a zero level, 50 ms at rest before it and 200 ms after it.
fn half_sine(peak: f64, zero_level: f64) -> Sampled {
    let at = |t: f64| {
        let pulse = if (0.0..=0.1).contains(&t) { peak * (std::f64::consts::PI * t / 0.1).sin() } else { 0.0 };
        pulse + zero_level
    };
    Sampled::new(-0.05, 1e-4, (-500..=3000).map(|k| at(f64::from(k) * 1e-4)).collect()).unwrap()
}

/// Change of velocity of the half sine of 200 m/s², 2·A·T/π.
const CHANGE: f64 = 2.0 * 200.0 * 0.1 / std::f64::consts::PI;

fn filtered(folder: &Path, waves: &[(&str, Sampled)], kind: Option<TestKind>, speed: Option<f64>) -> PathBuf {
    let channel = |id: &str| Channel {
        axis: Some(if id == "y" { Axis::Y } else { Axis::X }),
        cfc: Some(60),
        location: "vehicle, rear floor".to_owned(),
        ..Channel::new(id, QuantityKind::Acceleration)
    };
    let channels: Vec<_> = waves.iter().map(|(id, wave)| (channel(id), Some(wave.clone()))).collect();
    let kind = kind.map(|kind| KindOfTest { kind, rule: "stated by flag".to_owned() });
    let test = TestDescription {
        pulse: Some(waves[0].0.to_owned()),
        impact_speed_m_per_s: speed,
        mass_kg: Some(800.0),
        kind,
        ..TestDescription::default()
    };
    write_filtered(folder, test, &channels).unwrap()
}

fn metrics(artifact: &Artifact) -> Vec<MetricV1> {
    artifact.record::<MetricsV2>("/metrics").unwrap().unwrap().metrics
}

fn find(artifact: &Artifact, channel: &str, name: &str) -> MetricV1 {
    let all = metrics(artifact);
    all.into_iter().find(|metric| metric.name == name && metric.channel == channel).unwrap_or_else(|| panic!("{name}"))
}

fn value(artifact: &Artifact, name: &str) -> f64 {
    find(artifact, "p", name).value.unwrap_or_else(|| panic!("{name}"))
}

fn last(artifact: &Artifact, wave: &str) -> f64 {
    *artifact.waves()[wave].sampled.samples().last().unwrap()
}

fn notes(artifact: &Artifact) -> String {
    artifact.record::<NotesV1>("/notes").unwrap().unwrap().notes.join("\n")
}

#[test]
fn the_total_of_two_axes_needs_no_impact_speed() {
    let folder = tempfile::tempdir().unwrap();
    let waves = [("p", half_sine(-200.0, 0.0)), ("y", half_sine(-80.0, 0.0))];
    let artifact = result(&filtered(folder.path(), &waves, None, None), &[]);
    let value = |name: &str| find(&artifact, "p+y", name).value.unwrap();
    assert!((value("total_delta_v") / (CHANGE * 1.16_f64.sqrt()) - 1.0).abs() < 1e-4);
    assert!((value("total_delta_v_lateral") / (-0.4 * CHANGE) - 1.0).abs() < 1e-4);
    let direction = find(&artifact, "p+y", "principal_direction_of_force");
    assert!((direction.value.unwrap() - 0.4_f64.atan().to_degrees()).abs() < 1e-3);
    assert!(direction.definition.ends_with("from the right, 1 o'clock"), "{}", direction.definition);
}

#[test]
fn a_change_that_the_record_cuts_is_a_lower_bound() {
    let folder = tempfile::tempdir().unwrap();
    for (samples, is_cut) in [(800, true), (2500, false)] {
        let wave = half_sine(-200.0, 0.0).slice(0, samples);
        let delta_v = find(&result(&filtered(folder.path(), &[("p", wave)], None, None), &["--force"]), "p", "delta_v");
        assert_eq!(delta_v.is_lower_bound, is_cut, "{delta_v:?}");
    }
}

#[test]
fn a_braked_sled_has_velocity_and_stroke_and_no_crush() {
    let folder = tempfile::tempdir().unwrap();
    let input = filtered(folder.path(), &[("p", half_sine(-200.0, 0.0))], Some(TestKind::Sled), Some(CHANGE));
    let artifact = result(&input, &["--gain-uncertainty", "1% uniform"]);
    assert_eq!(artifact.record::<EventsV1>("/events").unwrap(), None);
    // The trapezoid of a half sine errs by (πT/D)²/12.
    assert!((value(&artifact, "delta_v") / CHANGE - 1.0).abs() < 1e-6);
    // A symmetric pulse stops within half of v0 times its length.
    assert!((value(&artifact, "stroke") - CHANGE * 0.05).abs() < 1e-4, "{}", value(&artifact, "stroke"));
    // A percent of gain is 0.9 % of the way that the pulse takes off v0·t, a half; when the force ends is nothing where
    // it stands.
    let stroke = find(&artifact, "p", "stroke");
    let [low, high] = [stroke.low, stroke.high].map(|end| end.unwrap() / (CHANGE * 0.05) - 1.0);
    assert!((-0.012..-0.008).contains(&low) && (0.008..0.012).contains(&high), "{stroke:?}");
    assert!(last(&artifact, "p/velocity").abs() < 1e-4 && artifact.waves().contains_key("p/displacement"));
    // A percent of gain is 0.9 % of the change at the ends of the interval.
    let delta_v = find(&artifact, "p", "delta_v");
    assert!((delta_v.high.unwrap() / CHANGE - 1.009).abs() < 5e-4, "{delta_v:?}");
    // From 10 to 90 % of a half sine: (asin 0.9 - asin 0.1)/π of its length.
    let rise_s = (0.9_f64.asin() - 0.1_f64.asin()) / std::f64::consts::PI * 0.1;
    assert!((value(&artifact, "rise_time") - rise_s).abs() < 1e-6);
    assert!(find(&artifact, "p", "dynamic_crush").value.is_none());
    let output = run(&input, &["--force"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(stderr.contains("stroke 637 mm") && stderr.contains("a sled has no structure"), "{stderr}");
    // The same record of a vehicle has a crush.
    let vehicle = filtered(folder.path(), &[("p", half_sine(-200.0, 0.0))], None, Some(CHANGE - 0.1));
    assert!(result(&vehicle, &["--force"]).record::<EventsV1>("/events").unwrap().is_some());
}

#[test]
fn a_known_end_takes_the_drift_out_of_a_push_and_the_number_said_is_written() {
    let folder = tempfile::tempdir().unwrap();
    for (speed, kind) in [(None, None), (Some(0.0), None), (Some(25.0), None), (None, Some(TestKind::Catapult))] {
        let from = speed.unwrap_or(0.0);
        let input = filtered(folder.path(), &[("p", half_sine(200.0, 3.0))], kind, speed);
        let end = format!("{}m/s", from + CHANGE);
        let artifact = result(&input, &["--force", "--end-velocity", &end]);
        assert!((last(&artifact, "p/velocity") - from - CHANGE).abs() < 1e-9, "{speed:?}");
        // The zero level, and nothing else, was taken out.
        assert!((value(&artifact, "drift_correction") - 3.0).abs() < 1e-4, "{speed:?}");
        assert!((value(&artifact, "delta_v") - CHANGE).abs() < 1e-4, "{speed:?}");
        assert!(notes(&artifact).contains(&format!("is {:.3} m/s as stated", from + CHANGE)), "{}", notes(&artifact));
        assert_eq!(artifact.record::<EventsV1>("/events").unwrap(), None);
        // The way: half of the change over the pulse, then all of it for 200 ms.
        let way = CHANGE * (0.05 + 0.2) + from * 0.3;
        let artifact = result(&input, &["--force", "--end-displacement", &format!("{way}m")]);
        assert!((last(&artifact, "p/displacement") - way).abs() < 1e-9, "{speed:?}");
        assert!((value(&artifact, "drift_correction") - 3.0).abs() < 1e-3, "{speed:?}");
    }
    let input = filtered(folder.path(), &[("p", half_sine(200.0, 0.0))], None, None);
    let output = run(&input, &["--force", "--end-displacement", "1m", "--end-velocity", "1m/s"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn the_other_channels_of_a_motion_from_rest_are_integrated_too() {
    let folder = tempfile::tempdir().unwrap();
    let waves = [("p", half_sine(200.0, 0.0)), ("q", half_sine(204.0, 0.0))];
    for speed in [None, Some(0.0)] {
        let input = filtered(folder.path(), &waves, None, speed);
        let artifact = result(&input, &["--force", "--channels", "all", "--zero-level-uncertainty", "0.05g uniform"]);
        assert!((last(&artifact, "q/velocity") - 1.02 * CHANGE).abs() < 1e-4);
        assert!(artifact.waves().contains_key("q/displacement") && artifact.waves().contains_key("q/velocity_change"));
        let both = find(&artifact, "p+q", "delta_v");
        assert!((both.high.unwrap() / both.low.unwrap() - 1.02).abs() < 1e-6, "{both:?}");
        // A zero level from 50 ms before contact to the end of the pulse, 5-95 %.
        let own = find(&artifact, "p", "delta_v");
        assert!((own.high.unwrap() - own.low.unwrap() - 2.0 * 0.9 * 0.05 * 9.806_65 * 0.15).abs() < 0.02, "{own:?}");
    }
}

#[test]
fn the_simple_pulse_that_fits_best_and_the_corridor_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let input = filtered(folder.path(), &[("p", half_sine(-200.0, 0.0))], Some(TestKind::Sled), Some(CHANGE));
    let artifact = result(&input, &["--corridor", "ece-r16"]);
    let said = notes(&artifact);
    assert!(said.contains("the simple pulse that fits best is a half sine of 20.1 g and"), "{said}");
    // The mean of 4.4 ms sees the end 1.3 ms late, so that even a half sine misses itself.
    assert!(value(&artifact, "simple_pulse_half_sine") < 0.02 && value(&artifact, "simple_pulse_haversine") > 0.05);
    // 20.4 g at most, where 26 g are demanded from 25 ms on.
    assert_eq!(value(&artifact, "sled_pulse_met"), 0.0);
    assert!((value(&artifact, "time_outside_corridor") - 0.01).abs() < 1.1e-4);
    assert!(
        said.contains("warning: sled pulse ece-r16 (UN R16 7.7 and annex 8, decelerated sled) is not met"),
        "{said}"
    );
    assert!(said.contains("velocity 45.8 km/h, expected 49.0 to 51.0 km/h"), "{said}");
    let output = run(&input, &["--force", "--corridor", "ece-r17"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && stderr.contains("14cfr-25.562-forward"), "{stderr}");
}

//! Real situations of the clock, the contact and its end: what is typed, and what is right. Of the shared material.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use std::process::Command;

use crumple_testkit::programs::{Steps, binary, code_and_error, records};
use crumple_testkit::{shared, workspace};
use serde_json::Value;

/// Folder of the case, file, flags of ingest.
type Typed<'a> = (&'a str, &'a str, &'a [&'a str]);

const VEHICLE: &[&str] = &["--mass=1200kg", "--impact-speed=50km/h"];

/// The records that integrate prints of a case through the default pipeline: the events and impacts under their topics,
/// and each metric of the pulse under its name.
fn found(root: &Path, (case, file, flags): Typed<'_>) -> serde_json::Map<String, Value> {
    let folder = tempfile::tempdir().unwrap();
    let pipeline = workspace().join("pipelines/default.toml");
    let ingest = binary("crumple-ingest");
    let steps = Steps { bin: ingest.parent().unwrap(), folder: folder.path(), pipeline: Some(&pipeline) };
    let record = root.join(case).join(file).to_string_lossy().into_owned();
    steps.run("ingest", &[&[record.as_str(), "-o", "1.mcap"], flags].concat()).unwrap();
    steps.run("filter", &["1.mcap", "-o", "2.mcap"]).unwrap();
    let printed = steps.run("integrate", &["2.mcap", "--json", "-o", "3.mcap"]).unwrap();
    let mut all = serde_json::Map::new();
    for (topic, data) in records(&printed, "/") {
        if topic == "metrics" {
            for metric in data["metrics"].as_array().into_iter().flatten() {
                all.entry(metric["name"].as_str().unwrap()).or_insert_with(|| metric.clone());
            }
        } else {
            all.insert(topic, data);
        }
    }
    all
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Whether the 90 % interval of an event holds a number, and its value is within a share of it.
fn assert_event(found: &serde_json::Map<String, Value>, name: &str, right: f64, share: f64, what: &str) {
    let events = &found["events"];
    let value = number(&events[name]);
    assert!((value / right - 1.0).abs() <= share, "{what}: {name} is {value}, right is {right}");
    let intervals = events["intervals"].as_array().unwrap();
    let of_name = intervals.iter().find(|interval| interval["name"] == name).unwrap();
    let [low, high] = ["low", "high"].map(|end| number(&of_name[end]));
    // What is right is stated to 0.05 mm and 0.05 km/h.
    let slack = 1e-3 * right;
    assert!((low - slack..=high + slack).contains(&right), "{what}: {name} is {low} to {high}, right is {right}");
}

#[test]
fn the_crush_is_right_wherever_contact_lies_and_whatever_is_before_it() {
    let Some(root) = shared("reference/cases") else { return };
    let sled: &[&str] = &["--mass=1500kg", "--impact-speed=56km/h"];
    let seat: &[&str] = &["--mass=600kg", "--impact-speed=48.3km/h"];
    let of_row = |flag: &'static str| [VEHICLE, &[flag]].concat();
    let (stated, packed) = (of_row("--time-zero=81.2847s"), of_row("--time-zero=200ms"));
    // Case, file, flags, crush in m.
    let cases: [(Typed<'_>, f64); 14] = [
        (("T4-m02-braking-before-contact", "braking-0.8g.csv", VEHICLE), 0.6429),
        (("T4-m02-braking-before-contact", "braking-0.4g.csv", VEHICLE), 0.6429),
        (("T4-m02-braking-before-contact", "calm-right-today.csv", VEHICLE), 0.6429),
        (("T4-m06-stops-within-the-speed-error", "short-by-0.05.csv", sled), 0.777),
        (("T4-m06-stops-within-the-speed-error", "rounded-speed-48.3.csv", seat), 1.146),
        (("T4-m06-stops-within-the-speed-error", "exact-right-today.csv", sled), 0.778),
        (("T4-12-packed-clock", "hhmmss.csv", &packed), 0.6429),
        (("T4-18-noise-decides-the-model", "a.csv", VEHICLE), 0.6429),
        (("T4-18-noise-decides-the-model", "b.csv", VEHICLE), 0.6429),
        (("T4-18-noise-decides-the-model", "c.csv", VEHICLE), 0.6429),
        (("T4-21-hint-on-the-shifted-axis", "boot.csv", VEHICLE), 0.6429),
        (("T4-21-hint-on-the-shifted-axis", "boot.csv", &stated), 0.6429),
        (("T4-f04-contact-before-time-zero", "contact-5ms-before.csv", VEHICLE), 0.6429),
        (("T4-f04-contact-before-time-zero", "contact-20ms-before.csv", VEHICLE), 0.6429),
    ];
    for (typed, crush_m) in cases {
        assert_event(&found(&root, typed), "dynamic_crush_m", crush_m, 0.01, &format!("{} {}", typed.0, typed.1));
    }
}

#[test]
fn braking_before_contact_leaves_the_change_of_velocity_of_the_impact() {
    let Some(root) = shared("reference/cases") else { return };
    for file in ["braking-0.8g.csv", "braking-0.4g.csv", "calm-right-today.csv"] {
        let found = found(&root, ("T4-m02-braking-before-contact", file, VEHICLE));
        assert_event(&found, "delta_v_m_per_s", 55.0 / 3.6, 0.01, file);
    }
}

#[test]
fn a_recorder_that_ends_in_the_pulse_has_a_lower_bound() {
    let Some(root) = shared("reference/cases") else { return };
    let cases = [
        ("ends-at-100ms.csv", 53.2, true),
        ("ends-at-80ms.csv", 34.0, true),
        ("ends-at-60ms.csv", 28.0, true),
        ("complete-right-today.csv", 61.2, false),
    ];
    for (file, km_per_h, is_bound) in cases {
        let found = found(&root, ("T4-m03-recorder-ends-in-the-pulse", file, &["--profile=edr"]));
        let delta_v = &found["maximum_delta_v"];
        let value = 3.6 * number(&delta_v["value"]).abs();
        assert!((value - km_per_h).abs() < 0.1, "{file}: {delta_v}");
        assert_eq!(delta_v["is_lower_bound"], is_bound, "{file}: {delta_v}");
    }
}

#[test]
fn each_impact_has_its_own_change_of_velocity_and_duration() {
    let Some(root) = shared("reference/cases") else { return };
    let changes = |file: &str| -> Vec<f64> {
        let found = found(&root, ("T4-m04-two-impacts", file, &["--mass=1200kg"]));
        let impacts = found["impacts"]["impacts"].as_array().unwrap().clone();
        impacts.iter().map(|impact| 3.6 * number(&impact["delta_v_m_per_s"])).collect()
    };
    for (file, right) in [("two-impacts.csv", &[20.0, 35.0][..]), ("one-impact-right-today.csv", &[20.0])] {
        let changes = changes(file);
        assert_eq!(changes.len(), right.len(), "{file}: {changes:?}");
        assert!(changes.iter().zip(right).all(|(change, right)| (change - right).abs() < 0.3), "{file}: {changes:?}");
    }
    let found = found(&root, ("T4-m17-duration-with-noise", "haversine-100ms.csv", &[]));
    let end_s = number(&found["impacts"]["impacts"][0]["end_s"]);
    assert!((end_s - 0.1).abs() <= 0.01, "{end_s}");
}

#[test]
fn what_is_pushed_has_its_change_of_velocity() {
    let Some(root) = shared("reference/cases") else { return };
    let of = |case, file, flags| {
        let found = found(&root, (case, file, flags));
        let delta_v = 3.6 * number(&found["delta_v"]["value"]).abs();
        (delta_v, found.get("stroke").cloned().unwrap_or_default())
    };
    const PUSHED: &str = "T4-m05-pushed-not-stopped";
    for flags in [&["--mass=1400kg"][..], &["--mass=1400kg", "--impact-speed=0km/h"]] {
        let (delta_v, _) = of(PUSHED, "struck-at-rest.csv", flags);
        assert!((delta_v - 12.9).abs() < 0.2, "{delta_v}");
    }
    let (delta_v, _) = of(PUSHED, "struck-moving.csv", &["--mass=1400kg", "--impact-speed=30km/h"]);
    assert!((delta_v - 15.0).abs() < 0.2, "{delta_v}");
    let (delta_v, stroke) = of(PUSHED, "sled-from-rest.csv", &[]);
    assert!((delta_v - 50.0).abs() < 0.3, "{delta_v}");
    let [low_m, high_m] = ["low", "high"].map(|end| number(&stroke[end]));
    // 4 ms of the end at 13.9 m/s are 56 mm, the other inputs 15.
    assert!((low_m..high_m).contains(&0.655) && high_m - low_m < 0.071, "{stroke}");
    let (delta_v, _) = of("T4-20-sled-that-is-pushed", "sled.csv", &[]);
    assert!((delta_v - 55.0).abs() < 0.3, "{delta_v}");
    const SECOND_VEHICLE: [&[&str]; 3] = [&["--vehicle=2"], &["--channel=2"], &["--vehicle-number=2"]];
    for flags in SECOND_VEHICLE {
        let (delta_v, _) = of("T4-10-struck-vehicle-at-rest", "v90001", flags);
        assert!((delta_v - 27.5).abs() < 0.3, "{flags:?}: {delta_v}");
    }
}

/// Shape of a pulse over the share of its length, 0 to 1, before it is scaled.
type Shape = fn(f64) -> f64;

#[test]
fn the_stroke_lies_in_its_interval_however_the_pulse_ends() {
    let shapes: [Shape; 4] = [
        |u| (PI * u).sin(),
        |u| (PI * u).sin().powi(2),
        |u| 1.0_f64.min(3.0 * u).min(3.0 * (1.0 - u)),
        // It ends in a jump.
        |_| 1.0,
    ];
    for (k, shape) in shapes.into_iter().enumerate() {
        for length_s in [0.06, 0.1] {
            let times = (0..3000).map(|k| f64::from(k) * 1e-4 - 0.1);
            let at = |t: f64| if (0.0..length_s).contains(&t) { shape(t / length_s) } else { 0.0 };
            // 50 km/h, and the way of a symmetric pulse: half of it times its length.
            let change = 50.0 / 3.6;
            let scale = change / (times.clone().map(at).sum::<f64>() * 1e-4);
            let rows: String = times.map(|t| format!("{t:.4},{:.5}\n", scale * at(t))).collect();
            let folder = tempfile::tempdir().unwrap();
            fs::write(folder.path().join("sled.csv"), format!("time [s],acceleration [m/s^2]\n{rows}")).unwrap();
            let flags = ["--kind=catapult", "--impact-speed=0km/h", "--time-zero=0s"];
            let stroke = &found(folder.path(), ("", "sled.csv", &flags))["stroke"];
            let [low_m, high_m] = ["low", "high"].map(|end| number(&stroke[end]));
            assert!((low_m..high_m).contains(&(0.5 * change * length_s)), "shape {k}, {length_s} s: {stroke}");
        }
    }
}

#[test]
fn the_hint_of_a_contact_outside_the_record_works_when_it_is_typed() {
    let Some(root) = shared("reference/cases") else { return };
    const CASE: (&str, &str) = ("T4-21-hint-on-the-shifted-axis", "boot.csv");
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(binary("crumple-ingest"));
    command.arg(root.join(CASE.0).join(CASE.1)).args(VEHICLE).args(["--time-zero", "50ms", "-o", "1.mcap"]);
    let (code, error) = code_and_error(command.current_dir(folder.path()));
    assert_eq!(code, 3, "{error}");
    assert!(error.contains("81.2347 s") && error.contains("81.4447 s"), "{error}");
    // The flag that the hint states.
    let flag = error.split("--time-zero ").nth(1).and_then(|rest| rest.split([',', ' ', '\n']).next()).unwrap();
    let flag = format!("--time-zero={flag}");
    let found = found(&root, (CASE.0, CASE.1, &[VEHICLE, &[flag.as_str()]].concat()));
    assert_event(&found, "dynamic_crush_m", 0.6429, 0.01, &flag);
}

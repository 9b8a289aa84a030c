//! ERA on records whose poles are known.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::path::{Path, PathBuf};

use crumple_identify::{EraOptions, Order, era};
use crumple_lti::Complex;
use serde_json::Value;

const DT_S: f64 = 1e-4;

/// The folder of records with known truth: `CRUMPLE_KNOWN_TRUTH`, else the shared material.
fn known_truth() -> Option<PathBuf> {
    match std::env::var_os("CRUMPLE_KNOWN_TRUTH") {
        Some(folder) => Some(folder.into()),
        None => crumple_testkit::shared("reference/known-truth"),
    }
}

/// The samples from time zero on (sample 0 is `D`), in g, and the truth.
fn load(folder: &Path, name: &str) -> (Vec<f64>, Value) {
    let csv = std::fs::read_to_string(folder.join(name).join("accel.csv")).unwrap();
    let samples = csv
        .lines()
        .filter_map(|line| {
            let (time, acceleration) = line.split_once(',')?;
            let time: f64 = time.parse().ok()?;
            (time > -DT_S / 2.0).then(|| acceleration.parse().unwrap())
        })
        .collect();
    let truth = std::fs::read_to_string(folder.join(name).join("truth.json")).unwrap();
    (samples, serde_json::from_str(&truth).unwrap())
}

fn poles(list: &Value) -> Vec<Complex> {
    let number = |v: &Value| v.as_f64().unwrap();
    list.as_array().unwrap().iter().map(|p| Complex::new(number(&p["re"]), number(&p["im"]))).collect()
}

/// Largest distance of a true pole to the nearest found one, relative to the true one.
fn worst_error(found: &[Complex], truth: &[Complex]) -> f64 {
    truth
        .iter()
        .map(|t| found.iter().map(|f| (f - t).norm()).fold(f64::INFINITY, f64::min) / t.norm())
        .fold(0.0, f64::max)
}

fn identify(samples: &[f64], order: usize, size: Option<(usize, usize)>) -> (Vec<Complex>, Vec<f64>) {
    let options = EraOptions {
        order: Order::Given(order),
        rows: size.map(|s| s.0),
        columns: size.map(|s| s.1),
        ..EraOptions::new(DT_S)
    };
    let model = era(samples, options).unwrap();
    (model.modes.iter().map(|m| m.mode.unwrap().pole).collect(), model.singular_values)
}

#[test]
fn clean_records_give_their_poles_back() {
    let Some(folder) = known_truth() else { return };
    for name in ["era-2state", "era-4state", "era-4state-close"] {
        let (samples, truth) = load(&folder, name);
        let order = truth["expected"]["order"].as_u64().unwrap() as usize;
        let true_poles = poles(&truth["expected"]["poles"]);
        assert_eq!((samples.len(), true_poles.len()), (2501, order), "{name}");
        let (found, values) = identify(&samples, order, None);
        let error = worst_error(&found, &true_poles);
        println!("{name}: whole record, order {order}: worst relative pole error {error:.1e}, {} values", values.len());
        // Asked for: 1e-9. What a 17-digit CSV allows is near 1e-13.
        assert!(error < 1e-11, "{name}: {error:e}");
    }
}

#[test]
fn every_size_of_the_reference_is_matched_clean_and_noisy() {
    let Some(folder) = known_truth() else { return };
    let mut compared = 0;
    for name in [
        "era-2state",
        "era-4state",
        "era-4state-close",
        "era-2state-noise1pct",
        "era-4state-noise1pct",
        "era-4state-close-noise1pct",
    ] {
        let (samples, truth) = load(&folder, name);
        let order = truth["expected"]["order"].as_u64().unwrap() as usize;
        let true_poles = poles(&truth["expected"]["poles"]);
        for reference in truth["reference_era_recovery"].as_array().unwrap() {
            let rows = reference["alpha"].as_u64().unwrap() as usize;
            let columns = reference["beta"].as_u64().unwrap() as usize;
            let (found, values) = identify(&samples, order, Some((rows, columns)));
            let error = worst_error(&found, &true_poles);
            let reference_error = reference["max_relative_pole_error"].as_f64().unwrap();
            println!("{name} {rows}x{columns}: {error:.2e}, reference {reference_error:.2e}");
            // The same algorithm: equal but for rounding. With two modes 7 % apart seen for a sixth of their beat
            // (close, 30x30) rounding is amplified by s1/s4 = 4e5 to about 1e-10; elsewhere to less than 1e-12.
            let rounding = if values[0] / values[order - 1] > 1e4 { 1e-9 } else { 1e-12 };
            assert!(error <= reference_error * (1.0 + 1e-6) + rounding, "{error:e} against {reference_error:e}");
            // Poles of the reference itself, where they are defined: not the sampling artefacts of 30x30 noise.
            let reference_poles = poles(&reference["continuous_poles"]);
            if reference_poles.iter().all(|p| p.im.abs() < 0.9 * std::f64::consts::PI / DT_S && p.im != 0.0) {
                assert!(worst_error(&found, &reference_poles) < 1e-6, "{found:?}");
            }
            for (k, value) in reference["first_singular_values"].as_array().unwrap().iter().take(order).enumerate() {
                let value = value.as_f64().unwrap();
                assert!((values[k] - value).abs() < 1e-12 * values[0], "value {k}: {} against {value}", values[k]);
            }
            compared += 1;
        }
    }
    assert_eq!(compared, 18);
}

#[test]
fn noisy_whole_records_come_as_close_as_the_longest_reference() {
    let Some(folder) = known_truth() else { return };
    for (name, limit) in
        [("era-2state-noise1pct", 1e-3), ("era-4state-noise1pct", 1e-2), ("era-4state-close-noise1pct", 1e-3)]
    {
        let (samples, truth) = load(&folder, name);
        let order = truth["expected"]["order"].as_u64().unwrap() as usize;
        let (found, _) = identify(&samples, order, None);
        let error = worst_error(&found, &poles(&truth["expected"]["poles"]));
        println!("{name}: whole record {error:.2e}");
        // The reference at its largest size has 2.8e-4, 2.7e-3, 7.3e-4. A record that has decayed into noise (4state:
        // after a fifth) gains nothing from the rest, so twice that, rounded up.
        assert!(error < limit, "{name}: {error:e}");
    }
}

//! Waveforms: two series of samples on the same grid.

use crumple_artifact::Wave;
use serde_json::{Value, json};

use crate::CompareSettings;
use crate::differences::{Difference, TopicReport};
use crate::tolerances::Base;
use crate::tolerances::Unit;

/// Two grids are the same if no sample's time moves by more than this part of the sampling interval, plus the
/// nanosecond to which the start is stored.
const GRID_PART_OF_INTERVAL: f64 = 1e-6;
const GRID_START_S: f64 = 1e-9;

/// Compares two waveforms: quantity, grid and length first, then sample by sample.
///
/// Relative differences refer to the largest magnitude of both waveforms: a sample near a zero crossing came out of
/// large ones and carries their rounding error. On different grids samples are not compared.
pub(crate) fn compare_waves(topic: &str, a: &Wave, b: &Wave, settings: &CompareSettings) -> TopicReport {
    let mut report = TopicReport::new(topic);
    let unit = Unit::from_symbol(a.quantity.si_unit());
    let tolerance = settings.tolerances.tolerance_of(topic, "", unit, None);
    if tolerance.is_any() {
        return report;
    }
    let mut frame = |place: &str, a: Value, b: Value| {
        let (abs, rel) = distance(&a, &b);
        report.differs(Difference { place: place.into(), a: Some(a), b: Some(b), abs, rel, ..Difference::default() });
    };
    if a.quantity != b.quantity {
        frame("quantity", json!(a.quantity.name()), json!(b.quantity.name()));
    }
    let (x, y) = (&a.sampled, &b.sampled);
    let slack = |part: f64, fixed: f64| {
        if settings.tolerances.base == Base::Exact { 0.0 } else { part * x.dt_s() + fixed }
    };
    let steps = x.len().max(y.len()).max(1) as f64;
    let same_interval = (x.dt_s() - y.dt_s()).abs() * steps <= slack(GRID_PART_OF_INTERVAL, 0.0);
    let same_start = (x.t0_s() - y.t0_s()).abs() <= slack(GRID_PART_OF_INTERVAL, GRID_START_S);
    if !same_interval {
        frame("dt_s", json!(x.dt_s()), json!(y.dt_s()));
    }
    if !same_start {
        frame("t0_s", json!(x.t0_s()), json!(y.t0_s()));
    }
    if x.len() != y.len() {
        frame("number of samples", json!(x.len()), json!(y.len()));
    }
    if !(same_interval && same_start) {
        return report;
    }

    let (x, y) = (x.samples(), y.samples());
    let scale = x.iter().chain(y).fold(0.0_f64, |most, value| most.max(value.abs()));
    let allowed = tolerance.abs + tolerance.rel * scale;
    let (mut first, mut worst, mut count) = (None, (0, 0.0), 0_u64);
    for (k, (p, q)) in x.iter().zip(y).enumerate() {
        let distance = (p - q).abs();
        if distance > worst.1 {
            worst = (k, distance);
        }
        if distance > allowed || (settings.bits && p.to_bits() != q.to_bits()) {
            first = first.or(Some(k));
            count += 1;
        }
    }
    let relative = |distance: f64| if distance == 0.0 { 0.0 } else { distance / scale };
    report.values = x.len().min(y.len()) as u64;
    report.max_abs = Some(worst.1);
    report.max_rel = Some(relative(worst.1));
    if let Some(first) = first {
        let at = |k: usize| {
            let distance = (x[k] - y[k]).abs();
            Difference {
                place: format!("sample {k}"),
                a: Some(json!(x[k])),
                b: Some(json!(y[k])),
                abs: Some(distance),
                rel: Some(relative(distance)),
                sample: Some(k as u64),
                time_s: Some(a.sampled.time_s(k)),
            }
        };
        report.differs(at(first));
        if worst.1 > (x[first] - y[first]).abs() {
            report.differences.push(at(worst.0));
        }
        report.different += count - 1;
    }
    report
}

fn distance(a: &Value, b: &Value) -> (Option<f64>, Option<f64>) {
    match (a.as_f64(), b.as_f64()) {
        (Some(a), Some(b)) => (Some((a - b).abs()), Some((a - b).abs() / a.abs().max(b.abs()).max(f64::MIN_POSITIVE))),
        _ => (None, None),
    }
}

#[cfg(test)]
mod tests {
    use crumple_signal::{QuantityKind, Sampled};

    use super::*;
    use crate::Tolerances;

    fn wave(t0_s: f64, samples: Vec<f64>) -> Wave {
        Wave { quantity: QuantityKind::Acceleration, sampled: Sampled::new(t0_s, 0.5, samples).unwrap() }
    }

    fn compare(a: &Wave, b: &Wave) -> TopicReport {
        compare_waves("/wave/93", a, b, &CompareSettings::default())
    }

    #[test]
    fn names_the_first_and_the_worst_sample() {
        let a = wave(-1.0, vec![0.0, 100.0, -200.0, 50.0]);
        let b = wave(-1.0, vec![0.0, 101.0, -200.0, 54.0]);
        let report = compare(&a, &b);
        assert_eq!((report.values, report.different), (4, 2));
        assert_eq!((report.max_abs, report.max_rel), (Some(4.0), Some(0.02)));
        let first = &report.differences[0];
        assert_eq!((first.sample, first.time_s, first.abs, first.rel), (Some(1), Some(-0.5), Some(1.0), Some(0.005)));
        assert_eq!((first.a.clone(), first.b.clone()), (Some(json!(100.0)), Some(json!(101.0))));
        assert_eq!(report.differences[1].sample, Some(3));
    }

    #[test]
    fn rounding_near_a_zero_crossing_is_no_difference_and_exact_sees_it() {
        let (a, b) = (wave(0.0, vec![200.0, 1e-15]), wave(0.0, vec![200.0, -1e-15]));
        let report = compare(&a, &b);
        assert!(report.same);
        assert_eq!(report.max_abs, Some(2e-15));
        let exact = Tolerances { base: Base::Exact, ..Tolerances::default() };
        let settings = CompareSettings { tolerances: exact, ..CompareSettings::default() };
        assert_eq!(compare_waves("/wave/93", &a, &b, &settings).different, 1);
    }

    #[test]
    fn another_grid_length_or_quantity_is_named() {
        let a = wave(0.0, vec![1.0, 2.0]);
        let places = |b: &Wave| compare(&a, b).differences.iter().map(|d| d.place.clone()).collect::<Vec<_>>();
        assert_eq!(places(&wave(0.1, vec![1.0, 9.0])), ["t0_s"]);
        assert_eq!(places(&wave(0.0, vec![1.0, 2.0, 3.0])), ["number of samples"]);
        assert_eq!(places(&wave(0.0, vec![1.5])), ["number of samples", "sample 0"]);
        let other = Wave { quantity: QuantityKind::Velocity, ..a.clone() };
        assert_eq!(places(&other), ["quantity"]);
        assert!(places(&wave(1e-10, vec![1.0, 2.0])).is_empty(), "below the resolution of the stored start");
    }

    #[test]
    fn empty_waveforms_are_the_same() {
        assert!(compare(&wave(0.0, vec![]), &wave(0.0, vec![])).same);
    }
}

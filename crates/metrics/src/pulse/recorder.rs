//! What the velocity change of an event data recorder says by itself, without an impact speed.

use crumple_signal::Sampled;

use crate::metric::definitions::{MAXIMUM_DELTA_V, TIME_OF_MAXIMUM_DELTA_V};
use crate::{Interval, IntervalBy, Metric};

/// Last moment that counts, s from time zero.
const LAST_S: f64 = 0.3;

/// Steps in which recorders keep a change of velocity, m/s: mph and km/h, whole, tenths and hundredths, the longest
/// first.
const STEPS_M_PER_S: [f64; 6] = [0.447_04, 1.0 / 3.6, 0.044_704, 0.1 / 3.6, 0.004_470_4, 0.01 / 3.6];

/// Maximum delta-V and the time to it, of a cumulative change of velocity along one axis (49 CFR 563.5).
///
/// The sample of largest magnitude from `time_zero_s` to 300 ms after it, less the value at time zero where the table
/// begins before it (one that begins at time zero or later counts from there, whatever its first row), and its time;
/// the first of equals. The value keeps its sign: a frontal impact is negative. Its interval is half of the step in
/// which the recorder prints, twice that where a row before it is subtracted; that of the time is half a sampling
/// interval. A lower bound has none, nor has a value whose step is not known. The trapezoid of an acceleration derived
/// from the table would lose what the smoothing takes off the peak. Absent without a sample at or after time zero.
pub fn maximum_delta_v(change: &Sampled, time_zero_s: f64) -> [Metric; 2] {
    let v = change.samples();
    // 1e-6 of a sample: the slack of decimal time stamps.
    let slack_s = 1e-6 * change.dt_s();
    let first = change.index_at_or_after(time_zero_s - slack_s);
    let Some(row) = v.get(first) else {
        return [&MAXIMUM_DELTA_V, &TIME_OF_MAXIMUM_DELTA_V]
            .map(|definition| Metric::absent(definition, "no sample at or after time zero"));
    };
    let start = if first > 0 { *row } else { 0.0 };
    let counting = (first..v.len()).take_while(|k| change.time_s(*k) - time_zero_s <= LAST_S + slack_s);
    let largest =
        counting.fold(first, |k, other| if (v[other] - start).abs() > (v[k] - start).abs() { other } else { k });
    let time_s = change.time_s(largest) - time_zero_s;
    let at = |metric: Metric| {
        let metric = metric.over(time_s, time_s);
        if largest + 1 == v.len() {
            metric.as_lower_bound("at the last sample of the table: a lower bound")
        } else {
            metric
        }
    };
    let within = |metric: Metric, half_width: Option<f64>| {
        let interval = metric.value.zip(half_width.filter(|_| largest + 1 < v.len())).map(|(value, half_width)| {
            Interval { low: value - half_width, high: value + half_width, by: IntervalBy::Resolution }
        });
        Metric { interval, ..metric }
    };
    let rounded_values = if start == 0.0 { 1.0 } else { 2.0 };
    let step = printed_step(v).map(|step| 0.5 * step * rounded_values);
    [
        within(at(Metric::with_value(&MAXIMUM_DELTA_V, v[largest] - start)), step),
        within(at(Metric::with_value(&TIME_OF_MAXIMUM_DELTA_V, time_s)), Some(0.5 * change.dt_s())),
    ]
}

/// The longest of the usual steps of which all values are whole multiples.
fn printed_step(values: &[f64]) -> Option<f64> {
    // A unit's factor is rounded once, and so is its multiple.
    let is_whole = |value: f64, step: f64| (value / step - (value / step).round()).abs() < 1e-6;
    let moves = values.iter().any(|value| *value != 0.0);
    STEPS_M_PER_S.into_iter().find(|step| moves && values.iter().all(|value| is_whole(*value, *step)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(v: &[f64]) -> (Option<f64>, Option<f64>) {
        let [dv, time] = maximum_delta_v(&Sampled::new(-0.01, 0.01, v.to_vec()).unwrap(), 0.0);
        // Time stamps are sums of decimal fractions.
        (dv.value, time.value.map(|t| (1e9 * t).round() / 1e9))
    }

    #[test]
    fn the_interval_is_half_of_the_step_of_the_table() {
        let table = |km_per_h: &[f64]| -> Vec<f64> { km_per_h.iter().map(|v| v / 3.6).collect() };
        let interval = |km_per_h: &[f64]| {
            let wave = Sampled::new(-0.01, 0.01, table(km_per_h)).unwrap();
            maximum_delta_v(&wave, 0.0).map(|metric| metric.interval.map(|i| (i.low, i.high)))
        };
        let near = |found: Option<(f64, f64)>, low: f64, high: f64| {
            let (a, b) = found.unwrap();
            assert!((a - low).abs() < 1e-9 && (b - high).abs() < 1e-9, "{a} to {b}");
        };
        let [change, time] = interval(&[0.0, 0.0, -3.0, -41.0, -40.0]);
        near(change, -41.5 / 3.6, -40.5 / 3.6);
        near(time, 0.015, 0.025);
        // Two rounded values.
        near(interval(&[0.0, -1.0, -3.0, -41.0, -40.0])[0], -41.0 / 3.6, -39.0 / 3.6);
        // Whole mph are no whole km/h.
        let mph = [0.0, 0.0, -7.0, -25.0, -24.0].map(|v| v * 1.609_344);
        near(interval(&mph)[0], -25.5 * 0.447_04, -24.5 * 0.447_04);
        assert_eq!(interval(&[0.0, 0.0, -3.151_592, -40.0])[0], None, "no step that is known");
        assert_eq!(interval(&[0.0, 0.0, -3.0, -40.0]), [None, None], "a lower bound");
    }

    #[test]
    fn the_first_sample_of_largest_magnitude_from_time_zero_on_counts() {
        assert_eq!(of(&[9.0, 0.0, -3.0, -5.0, -5.0, -4.0]), (Some(-5.0), Some(0.02)));
        assert_eq!(of(&[0.0, -1.0, -3.0, 4.0]).0, Some(5.0), "against the value at time zero");
        assert_eq!(of(&[0.0]), (None, None));
        // A table whose first row is 10 ms after time zero has lost something by then.
        let [dv, _] = maximum_delta_v(&Sampled::new(0.01, 0.01, vec![-3.0, -40.5, -40.0]).unwrap(), 0.0);
        assert_eq!(dv.value, Some(-40.5));
        let late: Vec<f64> = (0..60).map(f64::from).collect();
        // Sample 1 is time zero, sample 31 is 300 ms.
        let (dv, time) = of(&late);
        assert_eq!(dv, Some(30.0));
        assert!((time.unwrap() - 0.3).abs() < 1e-12);
    }

    #[test]
    fn a_table_that_ends_while_the_velocity_changes_gives_a_bound() {
        let [dv, _] = maximum_delta_v(&Sampled::new(0.0, 0.01, vec![0.0, -1.0, -2.0]).unwrap(), 0.0);
        assert!(dv.definition.ends_with("a lower bound"), "{}", dv.definition);
    }
}

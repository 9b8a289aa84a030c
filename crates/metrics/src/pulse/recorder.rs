//! What the velocity change of an event data recorder says by itself, without an impact speed.

use crumple_signal::Sampled;

use crate::Metric;
use crate::metric::definitions::{MAXIMUM_DELTA_V, TIME_OF_MAXIMUM_DELTA_V};

/// Last moment that counts, s from time zero.
const LAST_S: f64 = 0.3;

/// Maximum delta-V and the time to it, of a cumulative change of velocity along one axis (49 CFR 563.5).
///
/// The sample of largest magnitude from `time_zero_s` to 300 ms after it, less the value at time zero where the table begins before it (one
/// that begins at time zero or later counts from there, whatever its first row), and its time; the first of equals. The value keeps its sign: a frontal impact is negative. It is right to half of the step
/// in which the recorder prints, the time to half a sampling interval. The trapezoid of an acceleration derived from the table would lose what the
/// smoothing takes off the peak. Absent without a sample at or after time zero.
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
        if largest + 1 == v.len() { metric.remarked("at the last sample of the table: a lower bound") } else { metric }
    };
    [at(Metric::found(&MAXIMUM_DELTA_V, v[largest] - start)), at(Metric::found(&TIME_OF_MAXIMUM_DELTA_V, time_s))]
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

//! Time zero from the pulse itself, where no contact switch and no file says it.

use crumple_signal::{Acceleration, STANDARD_GRAVITY_M_PER_S2, Signal};

use crate::Metric;
use crate::metric::definitions::{TIME_ZERO_EDR, TIME_ZERO_THRESHOLD};
use crate::sums::window_end;
use crate::sums::{cumulative, in_samples};

/// Interval of the rule for event data recorders, s.
pub const EDR_INTERVAL_S: f64 = 0.02;
/// Change of velocity in it, m/s (0.8 km/h).
pub const EDR_CHANGE_M_PER_S: f64 = 0.8 / 3.6;

/// A level that must hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThresholdRule {
    /// |a| reached, m/s²: 0.5 g.
    pub threshold_m_per_s2: f64,
    /// Time it is held, s: 3 ms.
    pub hold_s: f64,
}

impl Default for ThresholdRule {
    fn default() -> Self {
        Self { threshold_m_per_s2: 0.5 * STANDARD_GRAVITY_M_PER_S2, hold_s: 0.003 }
    }
}

/// Time at which |a| crosses the threshold to stay there, s on the signal's axis, interpolated linearly.
///
/// The first sample with |a| at or above the threshold that stays there for 3 ms. On a CFC 60 signal without zero
/// level. It lags true contact, by 0.65 ms for a half-sine of 22 g over 90 ms; the price in displacement is v0 times
/// that. Absent where nothing holds.
pub fn time_zero_by_threshold(acceleration: &Signal<Acceleration>, rule: ThresholdRule) -> Metric {
    let a = acceleration.samples();
    let dt = acceleration.dt_s();
    let above = |k: usize| a[k].abs() >= rule.threshold_m_per_s2;
    let absent = || Metric::absent(&TIME_ZERO_THRESHOLD, "no stretch of the record holds the threshold");
    let Some(hold) = in_samples(rule.hold_s, dt).map(|(whole, part)| whole + usize::from(part > 0.0)) else {
        return absent();
    };
    let mut since = None;
    for k in 0..a.len() {
        if !above(k) {
            since = None;
            continue;
        }
        let start: usize = *since.get_or_insert(k);
        if k - start >= hold {
            let at = if start == 0 {
                0.0
            } else {
                let (low, high) = (a[start - 1].abs(), a[start].abs());
                (start - 1) as f64 + (rule.threshold_m_per_s2 - low) / (high - low)
            };
            return Metric::with_value(&TIME_ZERO_THRESHOLD, acceleration.t0_s() + at * dt);
        }
    }
    absent()
}

/// Rule of event data recorders: the first sample after which the velocity changes by more than 0.8 km/h within 20 ms,
/// s on the signal's axis (49 CFR 563.5). The point may precede contact by up to 20 ms.
pub fn time_zero_by_velocity_change(acceleration: &Signal<Acceleration>) -> Metric {
    let absent = || Metric::absent(&TIME_ZERO_EDR, "no 20 ms of the record change the velocity by more than 0.8 km/h");
    match changes_of_velocity(acceleration).position(|change| change > EDR_CHANGE_M_PER_S) {
        Some(k) => {
            let from_s = acceleration.time_s(k);
            Metric::with_value(&TIME_ZERO_EDR, from_s).over(from_s, from_s + EDR_INTERVAL_S)
        }
        None => absent(),
    }
}

/// End of the event by the same rule: the first sample at or after `from_s` after which the velocity changes by no more
/// than 0.8 km/h within 20 ms, s on the signal's axis.
pub fn event_end_by_velocity_change(acceleration: &Signal<Acceleration>, from_s: f64) -> Option<f64> {
    let first = acceleration.index_at_or_after(from_s);
    let after = changes_of_velocity(acceleration).skip(first).position(|change| change <= EDR_CHANGE_M_PER_S)?;
    Some(acceleration.time_s(first + after))
}

/// |Change of velocity| in the 20 ms that begin at each sample, m/s, by the trapezoid, its end interpolated.
fn changes_of_velocity(acceleration: &Signal<Acceleration>) -> impl Iterator<Item = f64> {
    let v = cumulative(acceleration.samples(), acceleration.dt_s());
    // An interval longer than any record leaves no start.
    let (whole, part) = in_samples(EDR_INTERVAL_S, acceleration.dt_s()).unwrap_or((v.len(), 0.0));
    let starts = 0..v.len().saturating_sub(whole + usize::from(part > 0.0));
    starts.map(move |k| (window_end(&v, k, whole, part) - v[k]).abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spike_does_not_hold_and_a_step_does() {
        let mut a = vec![0.0; 100];
        a[20] = 50.0;
        a[50..].fill(-10.0);
        let signal = Signal::new(-0.02, 1e-3, a).unwrap();
        let rule = ThresholdRule { threshold_m_per_s2: 5.0, hold_s: 0.003 };
        // Halfway between samples 49 and 50.
        assert!((time_zero_by_threshold(&signal, rule).value.unwrap() - 0.0295).abs() < 1e-12);
        let quiet = Signal::new(0.0, 1e-3, vec![1.0; 100]).unwrap();
        assert_eq!(time_zero_by_threshold(&quiet, rule).value, None);
        // The spike alone is 0.05 m/s; 0.23 m/s need 23 intervals of 10 m/s².
        assert_eq!(time_zero_by_velocity_change(&quiet).value, None);
    }
}

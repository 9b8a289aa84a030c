//! Cumulative sums and means over windows.

use crumple_signal::{Acceleration, Signal, Velocity};

use crate::metric::definitions::{SLIDING_MEAN, SM25};
use crate::{Definition, Metric};

/// Cumulative trapezoid from 0: `V[0] = 0`, `V[k] = V[k-1] + T·(a[k-1] + a[k])/2`.
pub fn cumulative(a: &[f64], dt_s: f64) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = a.windows(2).map(|pair| {
        sum += dt_s * (pair[0] + pair[1]) / 2.0;
        sum
    });
    a.first().map(|_| 0.0).into_iter().chain(steps).collect()
}

/// Cumulative trapezoid of the trapezoid: also the second integral.
pub(crate) fn cumulative_from(start: f64, rate: &[f64], dt_s: f64) -> Vec<f64> {
    let mut sums = cumulative(rate, dt_s);
    sums.iter_mut().for_each(|sum| *sum += start);
    sums
}

/// A length of time in whole samples and the fraction that is left, with a slack for decimal intervals.
///
/// `None` if it is negative, not finite, or longer than any record.
pub(crate) fn in_samples(length_s: f64, dt_s: f64) -> Option<(usize, f64)> {
    let x = length_s / dt_s;
    if !(0.0..9e15).contains(&x) {
        return None;
    }
    let nearest = x.round();
    // 1e-9 s is the slack of the definitions for windows; never more than a part of a sample.
    if (x - nearest).abs() * dt_s <= 1e-9_f64.min(1e-3 * dt_s) {
        return Some((nearest as usize, 0.0));
    }
    Some((x.floor() as usize, x - x.floor()))
}

/// Largest mean acceleration over a window of `window_s` that starts at a sample at or after `from_s`, m/s², as a
/// magnitude.
///
/// `max |V(t+w) - V(t)|/w` with V the cumulative trapezoid, interpolated linearly at t+w; t lies on the grid and t+w
/// inside the record. Between grid points the maximum is higher by at most `T²·max|a'|/(8w)`. The first of equals. The
/// window is on the signal's own axis. 25 ms give SM25. Absent where the record is shorter than the window.
pub fn sliding_mean(acceleration: &Signal<Acceleration>, window_s: f64, from_s: f64) -> Metric {
    let v = cumulative(acceleration.samples(), acceleration.dt_s());
    largest(&v, acceleration, window_s, from_s)
}

/// [`sliding_mean`] of a velocity that was integrated already.
pub fn sliding_mean_of_velocity(velocity: &Signal<Velocity>, window_s: f64, from_s: f64) -> Metric {
    largest(velocity.samples(), velocity, window_s, from_s)
}

fn definition(window_s: f64) -> &'static Definition {
    if (window_s - 0.025).abs() < 1e-12 { &SM25 } else { &SLIDING_MEAN }
}

fn largest(v: &[f64], grid: &crumple_signal::Sampled, window_s: f64, from_s: f64) -> Metric {
    let definition = definition(window_s);
    let first = grid.index_at_or_after(from_s);
    let short = || Metric::absent(definition, &format!("the record is shorter than the window of {window_s} s"));
    let Some((whole, fraction)) = in_samples(window_s, grid.dt_s()).filter(|_| window_s > 0.0) else { return short() };
    let best = best_start(v, first, whole, fraction);
    let Some((change, start)) = best else { return short() };
    let from_s = grid.time_s(start);
    Metric::with_value(definition, change / window_s).over(from_s, from_s + window_s)
}

/// Largest |V(k + whole + fraction) - V(k)| over k from `first`, and its k.
pub(crate) fn best_start(v: &[f64], first: usize, whole: usize, fraction: f64) -> Option<(f64, usize)> {
    let mut best = None;
    let reach = whole.saturating_add(usize::from(fraction > 0.0));
    for k in first..v.len().saturating_sub(reach) {
        let change = (window_end(v, k, whole, fraction) - v[k]).abs();
        if best.is_none_or(|(largest, _)| change > largest) {
            best = Some((change, k));
        }
    }
    best
}

/// V at `k + whole + fraction`, linear between samples; inside the record.
pub(crate) fn window_end(v: &[f64], k: usize, whole: usize, fraction: f64) -> f64 {
    let end = v[k + whole];
    if fraction > 0.0 { end + fraction * (v[k + whole + 1] - end) } else { end }
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn sums_by_the_trapezoid() {
        assert_eq!(cumulative(&[0.0, 2.0, 4.0], 0.5), [0.0, 0.5, 2.0]);
        assert!(cumulative(&[], 0.5).is_empty());
        assert_eq!(cumulative_from(4.0, &[2.0, 2.0], 0.5), [4.0, 5.0]);
    }

    #[test]
    fn a_decimal_window_is_whole_samples() {
        assert_eq!(in_samples(0.015, 1e-4), Some((150, 0.0)));
        assert_eq!(in_samples(0.75, 0.5), Some((1, 0.5)));
        // Intervals below 1 µs: the slack is a thousandth of one, not 1 ns.
        assert_eq!(in_samples(100.0e-8, 1e-8), Some((100, 0.0)));
        assert!(in_samples(100.01e-8, 1e-8).is_some_and(|(whole, part)| whole == 100 && part > 0.0));
        assert_eq!(in_samples(1.0 + 0.9e-9, 0.5), Some((2, 0.0)));
        assert!(in_samples(1.0 + 2e-9, 0.5).is_some_and(|(whole, part)| whole == 2 && part > 0.0));
        assert_eq!(in_samples(-0.1, 0.5), None);
        assert_eq!(in_samples(f64::NAN, 0.5), None);
    }

    #[test]
    fn finds_the_window_and_its_mean() {
        let a = Signal::new(0.0, 0.5, vec![0.0, -2.0, -2.0, 0.0, 0.0]).unwrap();
        let mean = sliding_mean(&a, 0.5, 0.0);
        assert_eq!((mean.value, mean.window.map(|w| w.from_s)), (Some(2.0), Some(0.5)));
        // One and a half samples: 0.5·2 + a quarter from V's chord (0.5).
        assert_eq!(sliding_mean(&a, 0.75, 0.0).value, Some(1.25 / 0.75));
        assert_eq!(sliding_mean(&a, 0.5, 1.5).value, Some(0.0));
    }

    #[test]
    fn a_record_shorter_than_the_window_has_none() {
        let mean = sliding_mean(&Signal::new(0.0, 1e-3, vec![-2.0; 25]).unwrap(), 0.025, 0.0);
        assert_eq!(mean.definition, "absent: the record is shorter than the window of 0.025 s");
        assert!(sliding_mean(&Signal::new(0.0, 1e-3, vec![-2.0; 26]).unwrap(), 0.025, 0.0).value.is_some());
    }
}

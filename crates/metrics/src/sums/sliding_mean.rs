use crumple_signal::{Acceleration, Signal, Velocity};

use crate::metric::definitions::{SLIDING_MEAN, SM25};
use crate::sums::cumulative::{cumulative, in_samples};
use crate::{Definition, Metric};

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
    Metric::found(definition, change / window_s).over(from_s, from_s + window_s)
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
    fn finds_the_window_and_its_mean() {
        let a = Signal::new(0.0, 0.5, vec![0.0, -2.0, -2.0, 0.0, 0.0]).unwrap();
        let found = sliding_mean(&a, 0.5, 0.0);
        assert_eq!((found.value, found.window.map(|w| w.from_s)), (Some(2.0), Some(0.5)));
        // One and a half samples: 0.5·2 + a quarter from V's chord (0.5).
        assert_eq!(sliding_mean(&a, 0.75, 0.0).value, Some(1.25 / 0.75));
        assert_eq!(sliding_mean(&a, 0.5, 1.5).value, Some(0.0));
    }

    #[test]
    fn a_record_shorter_than_the_window_has_none() {
        let found = sliding_mean(&Signal::new(0.0, 1e-3, vec![-2.0; 25]).unwrap(), 0.025, 0.0);
        assert_eq!(found.definition, "absent: the record is shorter than the window of 0.025 s");
        assert!(sliding_mean(&Signal::new(0.0, 1e-3, vec![-2.0; 26]).unwrap(), 0.025, 0.0).value.is_some());
    }
}

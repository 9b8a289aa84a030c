//! The uniform grid of printed time stamps.
//!
//! Printed times are rounded, so neither their differences nor `(t_last - t_first)/(n - 1)` is the recorder's interval
//! to the last bit. The rule here: the interval is the decimal number with the fewest significant digits that agrees
//! with the first and the last stamp within their printed resolution `q`, i.e. within `q/(n - 1)`; for up to six
//! digits, within 1e-12 of it at least. Stamps `-0.0200, -0.0199, ...` give exactly `1e-4` s; stamps with 18 digits at
//! 20.0027797 us keep what they say. The first stamp is taken as printed.
//!
//! A record is uniform if every step differs from the interval by less than 1e-3 of it (crash-pulse practice for
//! filtering), or if the stamps are coarsely printed (`q` up to half an interval) and every stamp lies within `q` of
//! the grid: 16 kHz printed to the microsecond.

use crate::Result;

/// Largest accepted deviation of a step from the interval, as a fraction of it.
pub const STEP_TOLERANCE: f64 = 1e-3;

/// A uniform grid and how well the stamps fit it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Time of the first sample, s.
    pub t0_s: f64,
    /// Interval, s.
    pub dt_s: f64,
    /// Largest distance of a stamp from the grid, in intervals.
    pub jitter: f64,
}

/// Why stamps do not form a grid. `index` is that of the later of two samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GridError {
    /// A stamp equals the one before.
    Repeated { index: usize },
    /// A stamp is earlier than the one before.
    Backwards { index: usize },
    /// A step is too far from the interval of the record.
    Uneven { index: usize, step_s: f64, dt_s: f64 },
}

/// Fits a grid to time stamps in seconds, at least two. `resolution_s` is the printed resolution of the stamps.
pub fn fit(times_s: &[f64], resolution_s: f64) -> Result<Grid, GridError> {
    for (k, pair) in times_s.windows(2).enumerate() {
        if pair[1] <= pair[0] {
            let index = k + 1;
            let is_repeated = pair[1] == pair[0];
            return Err(if is_repeated { GridError::Repeated { index } } else { GridError::Backwards { index } });
        }
    }
    let n = times_s.len();
    let (first, last) = (times_s[0], times_s[n - 1]);
    let largest = first.abs().max(last.abs());
    // Two units in the last place for the parse of each end.
    let resolution = resolution_s.max(2.0 * f64::EPSILON * largest);
    let steps = (n - 1) as f64;
    let dt = shortest((last - first) / steps, resolution / steps);
    let mut jitter = 0.0_f64;
    let mut worst_step = (0, 0.0_f64);
    for (k, time) in times_s.iter().enumerate() {
        jitter = jitter.max((time - (first + k as f64 * dt)).abs());
        if k > 0 {
            let off = (time - times_s[k - 1] - dt).abs();
            if off > worst_step.1 {
                worst_step = (k, off);
            }
        }
    }
    let even = worst_step.1 <= STEP_TOLERANCE * dt + 4.0 * f64::EPSILON * largest;
    let coarse = resolution <= 0.5 * dt && jitter <= resolution * (1.0 + 1e-6);
    if !(even || coarse) {
        let index = worst_step.0;
        let (step_s, dt_s) = (times_s[index] - times_s[index - 1], median_step(times_s));
        return Err(GridError::Uneven { index, step_s, dt_s });
    }
    Ok(Grid { t0_s: first, dt_s: dt, jitter: jitter / dt })
}

/// The decimal number with the fewest significant digits within `tolerance` of `x` (positive); `x` itself if none is.
///
/// A number of up to six digits is also taken within 1e-12 of `x`: stamps made by adding up the interval carry that
/// much rounding even where they are printed to 18 digits.
pub fn shortest(x: f64, tolerance: f64) -> f64 {
    (0..17)
        .filter_map(|digits| format!("{x:.digits$e}").parse::<f64>().ok().map(|round| (digits, round)))
        .find(|(digits, round)| {
            let slack = if *digits < 6 { tolerance.max(1e-12 * x) } else { tolerance };
            (round - x).abs() <= slack && *round > 0.0
        })
        .map_or(x, |(_, round)| round)
}

/// Median of the steps, s; of a million steps spread evenly over a longer record.
pub fn median_step(times_s: &[f64]) -> f64 {
    let stride = (times_s.len() >> 20).max(1);
    let mut steps: Vec<f64> = times_s.windows(2).step_by(stride).map(|pair| pair[1] - pair[0]).collect();
    if steps.is_empty() {
        return 0.0;
    }
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(t0: f64, dt: f64, n: usize, decimals: usize) -> Vec<f64> {
        (0..n).map(|k| format!("{:.decimals$}", t0 + k as f64 * dt).parse().unwrap()).collect()
    }

    #[test]
    fn printed_rates_come_back_exactly() {
        for (dt, decimals) in [(1e-4, 4), (1e-4, 6), (5e-5, 5), (6.25e-5, 6), (1e-3, 3), (1e-6, 6), (1.25e-5, 7)] {
            let grid = fit(&printed(-0.02, dt, 2701, decimals), 10_f64.powf(-(decimals as f64))).unwrap();
            assert_eq!((grid.t0_s, grid.dt_s), (-0.02, dt), "{decimals} decimals");
        }
    }

    #[test]
    fn an_odd_interval_is_kept() {
        let dt = 2.000_277_970_813_059_3e-5;
        let times: Vec<f64> = (0..1439).map(|k| k as f64 * dt).collect();
        let grid = fit(&times, 1e-20).unwrap();
        // The ends are rounded to half a unit in the last place each.
        assert!((grid.dt_s / dt - 1.0).abs() < 4.0 * f64::EPSILON, "{}", grid.dt_s);
    }

    #[test]
    fn a_missing_sample_is_found_however_coarse_the_print() {
        for decimals in [4, 6] {
            let mut times = printed(0.0, 1e-4, 2000, decimals);
            times.remove(1000);
            let error = fit(&times, 10_f64.powf(-(decimals as f64))).unwrap_err();
            assert!(matches!(error, GridError::Uneven { index: 1000, .. }), "{error:?}");
        }
    }

    #[test]
    fn order_is_checked_first() {
        assert_eq!(fit(&[0.0, 1.0, 1.0, 2.0], 1e-3), Err(GridError::Repeated { index: 2 }));
        assert_eq!(fit(&[0.0, 1.0, 0.5, 2.0], 1e-3), Err(GridError::Backwards { index: 2 }));
    }
}

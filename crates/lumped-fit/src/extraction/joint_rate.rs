//! One rate factor for several tests: a search in one number around the linear problem.

use super::extract::extract;
use super::problem::{AskedCurve, Extraction, MeasuredTest};

/// The largest rate factor looked at, s/m: beyond foams and hydraulic dampers.
const LARGEST_S_PER_M: f64 = 0.2;
/// Points of the first look.
const POINTS: usize = 40;

/// A rate factor known beforehand: mean and standard deviation, s/m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RatePrior {
    /// Most probable value.
    pub mean_s_per_m: f64,
    /// Standard deviation.
    pub deviation_s_per_m: f64,
}

/// The rate factor, not negative, common to all curves, with which the equations of motion are met best, and what is
/// extracted with it.
///
/// For every rate factor the problem is linear; what is left is looked at on a grid and then by sections. Tests at
/// different speeds determine it; of a single test it is biased by any bend of the curve near its end, so state a
/// prior there: it counts as one more equation. `None`: as for [`extract`].
pub fn extract_with_rate(
    tests: &[MeasuredTest],
    curves: &[AskedCurve],
    slope_change_weight: f64,
    prior: Option<RatePrior>,
) -> Option<(f64, Extraction)> {
    let with = |rate_s_per_m: f64| {
        let curves: Vec<AskedCurve> = curves.iter().map(|curve| AskedCurve { rate_s_per_m, ..curve.clone() }).collect();
        extract(tests, &curves, slope_change_weight)
    };
    // Root of the sum of squares: near an exact record it has a corner, which sections find to rounding.
    let misfit = |rate: f64| -> Option<f64> {
        let surprise = prior.map_or(0.0, |p| ((rate - p.mean_s_per_m) / p.deviation_s_per_m).powi(2));
        Some((with(rate)?.objective + surprise).sqrt())
    };
    let at = |i: usize| LARGEST_S_PER_M * i as f64 / POINTS as f64;
    let looks: Vec<f64> = (0..=POINTS).map(|i| misfit(at(i))).collect::<Option<_>>()?;
    let lowest = (0..=POINTS).min_by(|a, b| looks[*a].total_cmp(&looks[*b]))?;
    let (mut low, mut high) = (at(lowest.saturating_sub(1)), at((lowest + 1).min(POINTS)));
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut left, mut right) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_left, mut at_right) = (misfit(left)?, misfit(right)?);
    while high - low > 1e-12 {
        if at_left <= at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - golden * (high - low);
            at_left = misfit(left)?;
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + golden * (high - low);
            at_right = misfit(right)?;
        }
    }
    let rate = [low, 0.5 * (low + high), high].into_iter().min_by(|a, b| {
        let misfit = |rate: &f64| misfit(*rate).unwrap_or(f64::INFINITY);
        misfit(a).total_cmp(&misfit(b))
    })?;
    Some((rate, with(rate)?))
}

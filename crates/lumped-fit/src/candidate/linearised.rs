//! Standard deviations of a fit, linearised about its minimum.

use std::collections::BTreeMap;

use crumple_estimation::minimise::levenberg_marquardt::Optimum;
use crumple_estimation::statistics::lag_1_autocorrelation;
use crumple_linalg::jacobi_svd;
use nalgebra::DMatrix;

use crate::Uncertainty;

/// How these deviations were made, as the record says it.
pub(crate) const LINEARISED: &str = "linearised, autocorrelated residuals";

/// Standard deviations of the parameters `p_i`, whose derivatives by the coordinates of the fit are `factors`, in the
/// unit of each: `s_i = |factor_i| sqrt(v [(J'J)^-1]_ii)`.
///
/// `J` holds the derivatives of the residuals by the coordinates at the minimum, one column each; `best.r` is its
/// triangle. The variance is that of the residuals, `v = cost/(n - p) (1 + r)/(1 - r)`: `n` residuals, `p`
/// coordinates off their bounds, and the lag-1 autocorrelation `r`, since `n` samples of noise that is correlated in
/// time are worth `n (1 - r)/(1 + r)` independent ones.
///
/// First order: right while the response is straight over the interval, and only if the model is true. Too small
/// where the residuals are systematic; [`assess`](crate::assess) replaces it by the covariance with the whole
/// autocovariance. A parameter on a bound has no deviation. `None` where every parameter is on a bound, one has no
/// effect, no residual is left over, or the sensitivities have not full rank.
pub fn uncertainty(best: &Optimum, residuals: &[f64], names: &[&'static str], factors: &[f64]) -> Option<Uncertainty> {
    let free: Vec<usize> = (0..names.len()).filter(|&i| !best.on_bound[i]).collect();
    let norms: Vec<f64> = best.r.column_iter().map(|c| c.norm()).collect();
    if free.is_empty() || free.iter().any(|&i| norms[i] == 0.0) || residuals.len() <= free.len() {
        return None;
    }
    let n = names.len();
    let scaled = DMatrix::from_fn(n, free.len(), |i, j| best.r[(i, free[j])] / norms[free[j]]);
    let svd = jacobi_svd(&scaled)?;
    let (largest, smallest) = (svd.values[0], svd.values[free.len() - 1]);
    if smallest <= 0.0 {
        return None;
    }
    let rho = lag_1_autocorrelation(residuals);
    let variance = best.cost / (residuals.len() - free.len()) as f64 * (1.0 + rho) / (1.0 - rho);
    let standard_deviation: BTreeMap<_, _> = free
        .iter()
        .enumerate()
        .map(|(j, &i)| {
            let inverse: f64 = (0..free.len()).map(|k| (svd.right[(j, k)] / svd.values[k]).powi(2)).sum();
            (names[i], (variance * inverse).sqrt() / norms[i] * factors[i].abs())
        })
        .collect();
    standard_deviation.values().all(|d| d.is_finite()).then_some(Uncertainty {
        method: LINEARISED,
        standard_deviation,
        condition: largest / smallest,
        residual_autocorrelation: Some(rho),
    })
}

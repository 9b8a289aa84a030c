//! Standard deviations of a fit, linearised about its minimum.

use std::collections::BTreeMap;

use crumple_estimation::minimise::levenberg_marquardt::Optimum;
use crumple_estimation::statistics::lag_1_autocorrelation;
use crumple_linalg::jacobi_svd;
use nalgebra::DMatrix;

use crate::Uncertainty;

/// What the uncertainty of a fit by iteration is made from.
pub(crate) const LINEARISED: &str = "linearised, autocorrelated residuals";

/// Linearised deviations of the parameters `factor_i theta_i`, as the fit of the double model has them:
/// `sigma² (J'J)^-1`, widened for the lag-1 autocorrelation of the residuals. Those on a bound have none; `None` where
/// nothing is left.
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

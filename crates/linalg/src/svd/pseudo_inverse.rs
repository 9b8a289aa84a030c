//! Numerical rank and pseudo-inverse of small matrices, both from singular values.
//!
//! One tolerance for both, 1e-12 of the largest value: what lies below is taken for rounding of data of size one.

use crate::svd::jacobi_svd;
use nalgebra::DMatrix;

/// Singular values below this fraction of the largest are rounding.
const RANK_TOLERANCE: f64 = 1e-12;

/// How many of the singular values, largest first, are more than rounding of the largest.
pub fn numerical_rank(values: &[f64]) -> usize {
    let tolerance = values.first().copied().unwrap_or(0.0) * RANK_TOLERANCE;
    values.iter().take_while(|s| **s > tolerance).count()
}

/// `pinv(a) b`, singular values below 1e-12 of the largest taken for zero; `a` has at least as many rows as columns.
pub fn pseudo_inverse_times(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let svd = jacobi_svd(a)?;
    let rank = numerical_rank(&svd.values);
    let mut parts = svd.left.columns(0, rank).tr_mul(b);
    for (k, s) in svd.values[..rank].iter().enumerate() {
        parts.row_mut(k).unscale_mut(*s);
    }
    Some(svd.right.columns(0, rank) * parts)
}

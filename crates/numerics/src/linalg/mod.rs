//! Linear algebra of small dense matrices, beside what nalgebra has: singular values to full relative accuracy, least
//! squares without normal equations, inner products in a fixed order; and the Fourier transforms of all crates.
//!
//! Every function gives the same bits for the same input: sums run in an order that is written down, and no routine
//! picks another one by the processor, but the Fourier transform. Matrices are nalgebra's `DMatrix<f64>`, column-major;
//! vectors are slices.

use std::sync::Arc;

use nalgebra::{DMatrix, SymmetricEigen};
use pulp::{Arch, Simd, WithSimd};
use realfft::RealFftPlanner;

pub use least_squares::{CONDITION_LIMIT, Solution, TriangularFactor, nonnegative_least_squares};
pub use realfft::num_complex::Complex64;
pub use realfft::{ComplexToReal, RealToComplex};

mod least_squares;

// The singular value decomposition of a small matrix, by one-sided Jacobi rotations.
//
// One-sided rotations keep small singular values to full relative accuracy, which the order of a system and the
// weakest direction of a fit are read from.

/// Sweeps after which it counts as stuck; two to four are usual.
const MAX_SWEEPS: usize = 60;

/// QR steps per eigenvalue before the start is given up; two are usual.
const EIGEN_STEPS_PER_VALUE: usize = 60;

/// Cosine between two columns that counts as orthogonal.
const ORTHOGONAL: f64 = 2e-15;

/// Columns below this fraction of the largest are rounding and are left alone.
const NEGLIGIBLE: f64 = 1e-16;

/// `a = U S V'`, largest value first.
#[derive(Debug, Clone)]
pub struct SmallSvd {
    /// Singular values.
    pub values: Vec<f64>,
    /// Left vectors as columns; a column of zeros where the value is zero.
    pub left: DMatrix<f64>,
    /// Right vectors as columns.
    pub right: DMatrix<f64>,
}

/// Decomposes a matrix with at least as many rows as columns; `None` if the rotations do not settle.
///
/// Own code because nalgebra's SVD (0.35) does not hold its accuracy: on random bidiagonal matrices of 3 to 100 rows
/// its factors multiply back to errors of 1e-12, at times 1e-3; these to 1e-15. Fit for matrices up to a
/// few hundred columns.
///
/// Hestenes 1958; Demmel & Veselić, "Jacobi's method is more accurate than QR", SIAM J. Matrix Anal. 13(4), 1992.
pub fn jacobi_svd(a: &DMatrix<f64>) -> Option<SmallSvd> {
    let n = a.ncols();
    if n == 0 {
        return Some(SmallSvd { values: Vec::new(), left: a.clone(), right: DMatrix::zeros(0, 0) });
    }
    // The eigenvectors of a'a are the right vectors, up to the half of the digits that squaring costs; the rotations
    // restore them in a few sweeps instead of ten.
    let start = SymmetricEigen::try_new(a.tr_mul(a), f64::EPSILON, EIGEN_STEPS_PER_VALUE * n)
        .map_or_else(|| DMatrix::identity(n, n), |eigen| eigen.eigenvectors);
    let mut columns = to_columns(&(a * &start));
    let mut right = to_columns(&start);
    let negligible = columns.iter().map(|c| dot(c, c)).fold(0.0, f64::max) * NEGLIGIBLE * NEGLIGIBLE;
    let mut settled = false;
    for _ in 0..MAX_SWEEPS {
        settled = true;
        for p in 0..n {
            for q in p + 1..n {
                let (pp, qq) = (dot(&columns[p], &columns[p]), dot(&columns[q], &columns[q]));
                if qq > pp {
                    // Larger columns first, which is faster. The pairs passed over before belong to other columns now.
                    settled = false;
                    columns.swap(p, q);
                    right.swap(p, q);
                }
                let (pp, qq) = (pp.max(qq), pp.min(qq));
                let pq = dot(&columns[p], &columns[q]);
                if qq <= negligible || pq.abs() <= ORTHOGONAL * (pp * qq).sqrt() {
                    continue;
                }
                settled = false;
                let zeta = (qq - pp) / (2.0 * pq);
                let tangent = 1.0_f64.copysign(zeta) / (zeta.abs() + zeta.hypot(1.0));
                rotate(&mut columns, p, q, tangent);
                rotate(&mut right, p, q, tangent);
            }
        }
        if settled {
            break;
        }
    }
    if !settled {
        return None;
    }
    let values: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt()).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| values[j].total_cmp(&values[i]));
    let scaled = |i: usize, x: f64| if values[i] > 0.0 { x / values[i] } else { 0.0 };
    Some(SmallSvd {
        left: DMatrix::from_fn(a.nrows(), n, |i, j| scaled(order[j], columns[order[j]][i])),
        right: DMatrix::from_fn(n, n, |i, j| right[order[j]][i]),
        values: order.into_iter().map(|i| values[i]).collect(),
    })
}

/// The columns of a matrix, each in a vector of its own.
fn to_columns(a: &DMatrix<f64>) -> Vec<Vec<f64>> {
    a.column_iter().map(|column| column.iter().copied().collect()).collect()
}

/// Rotates columns `p < q` by the angle of this tangent: `(c x - s y, s x + c y)`.
fn rotate(columns: &mut [Vec<f64>], p: usize, q: usize, tangent: f64) {
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = cosine * tangent;
    let (head, tail) = columns.split_at_mut(q);
    for (x, y) in head[p].iter_mut().zip(&mut tail[0]) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
}

// Numerical rank and pseudo-inverse of small matrices, both from singular values.
//
// One tolerance for both, 1e-12 of the largest value: what lies below is taken for rounding of data of size one.

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

// The inner product of two slices.
//
// Sums of eight interleaved parts: faster than one running sum, and its rounding error grows with an eighth of the
// length.

/// Inner product of slices of one length, in eight interleaved sums: the same bits in vectors of any width.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    if a.len() < WIDER { dot_here(a, b) } else { Arch::new().dispatch(Dot(a, b)) }
}

/// Length from which asking the processor for its widest vectors costs less than they save. Ours: 64 products take
/// longer than to ask.
const WIDER: usize = 64;

struct Dot<'a>(&'a [f64], &'a [f64]);

impl WithSimd for Dot<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        dot_here(self.0, self.1)
    }
}

/// [`dot`] in the vectors of the caller.
#[inline(always)]
pub(crate) fn dot_here(a: &[f64], b: &[f64]) -> f64 {
    debug_assert_eq!(a.len(), b.len(), "an inner product is of slices of one length");
    let mut sums = [0.0; 8];
    let (a_chunks, b_chunks) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a_chunks.remainder().iter().zip(b_chunks.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_chunks.zip(b_chunks) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}

// Plans of the discrete Fourier transform of real vectors.
//
// The transforms are generic, and a crate that plans one itself compiles all of them, ten seconds each: they are
// planned here, once for the workspace.

/// The transform of one length and its inverse.
pub struct RealTransform {
    /// `X_k = Σ x_n e^(-2πi·kn/N)`, k = 0 to N/2, of `N` real values.
    pub forward: Arc<dyn RealToComplex<f64>>,
    /// `N·x_n` of those `N/2 + 1` values: the inverse without its factor `1/N`.
    pub inverse: Arc<dyn ComplexToReal<f64>>,
}

/// Plans the transform of `length` real values, any number of them; fastest for products of 2, 3 and 5.
///
/// Time `O(N log N)`, error of a value about `1e-16·log2 N` of the norm of the input. Both use their input as scratch.
/// The order of summation follows the vector instructions that the processor has.
pub fn real_transform(length: usize) -> RealTransform {
    let mut planner = RealFftPlanner::new();
    RealTransform { forward: planner.plan_fft_forward(length), inverse: planner.plan_fft_inverse(length) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use proptest::prelude::*;

    use super::*;
    use std::f64::consts::PI;

    fn check(a: &DMatrix<f64>) -> Result<(), TestCaseError> {
        let svd = jacobi_svd(a).unwrap();
        let s = DMatrix::from_diagonal(&nalgebra::DVector::from_column_slice(&svd.values));
        let norm = a.norm().max(1e-300);
        let n = a.ncols();
        // A few rounding units per rotation and sweep.
        prop_assert!((&svd.left * s * svd.right.transpose() - a).norm() < 2e-14 * norm);
        prop_assert!((svd.right.transpose() * &svd.right - DMatrix::identity(n, n)).norm() < 1e-13);
        prop_assert!(svd.values.windows(2).all(|w| w[0] >= w[1]));
        let significant = svd.values.iter().filter(|s| **s > 1e-14 * norm).count();
        let u = svd.left.columns(0, significant);
        let skew = (u.transpose() * u - DMatrix::identity(significant, significant)).norm();
        // Every pair is orthogonal to 2e-15, and there are up to 30² pairs; the smallest columns carry rounding of the
        // largest.
        prop_assert!(skew < 1e-13, "{skew:e}, values {:?}", svd.values);
        Ok(())
    }

    proptest! {
        #[test]
        fn factors_multiply_back_for_bidiagonal_matrices_of_any_grading(
            entries in prop::collection::vec(0.0..1.0_f64, 2..60), decades in 0.0..14.0_f64, position in 0..60_usize,
        ) {
            let n = entries.len() / 2;
            let mut a = DMatrix::zeros(n, n);
            for k in 0..n {
                // From some row on everything is small: the shape of a finished Lanczos run.
                let scale = if k >= position { 10.0_f64.powf(-decades) } else { 1.0 };
                a[(k, k)] = entries[2 * k] * scale;
                if k + 1 < n {
                    a[(k, k + 1)] = entries[2 * k + 1] * scale;
                }
            }
            check(&a)?;
        }

        #[test]
        fn factors_multiply_back_for_tall_matrices_of_low_rank(entries in prop::collection::vec(-1.0..1.0_f64, 36)) {
            let (tall, wide) = entries.split_at(24);
            let a = DMatrix::from_column_slice(12, 2, tall) * DMatrix::from_column_slice(2, 6, wide);
            check(&a)?;
        }
    }

    #[test]
    fn diagonal_and_zero_matrices_are_their_own_answer() {
        let svd = jacobi_svd(&DMatrix::from_diagonal(&nalgebra::dvector![1.0, -3.0, 0.0])).unwrap();
        assert_eq!(svd.values, [3.0, 1.0, 0.0]);
        assert_eq!(jacobi_svd(&DMatrix::zeros(3, 2)).unwrap().values, [0.0, 0.0]);
        assert!(jacobi_svd(&DMatrix::zeros(0, 0)).unwrap().values.is_empty());
    }

    #[test]
    fn the_sum_of_the_definition_and_back() {
        for length in [1, 2, 15, 31, 64] {
            let x: Vec<f64> = (0..length).map(|n| ((n * n) as f64 * 0.7).sin()).collect();
            let plan = real_transform(length);
            let mut spectrum = plan.forward.make_output_vec();
            plan.forward.process(&mut x.clone(), &mut spectrum).unwrap();
            for (k, value) in spectrum.iter().enumerate() {
                let angle = |n: usize| -2.0 * PI * (k * n) as f64 / length as f64;
                let re: f64 = x.iter().enumerate().map(|(n, x)| x * angle(n).cos()).sum();
                let im: f64 = x.iter().enumerate().map(|(n, x)| x * angle(n).sin()).sum();
                // The angles are rounded: some 1e-16 of 2π·k·n/N each, 64 terms.
                assert!((value.re - re).hypot(value.im - im) < 1e-12 * length as f64, "{length} {k}");
            }
            let mut back = plan.inverse.make_output_vec();
            plan.inverse.process(&mut spectrum, &mut back).unwrap();
            for (x, back) in x.iter().zip(back) {
                assert!((back / length as f64 - x).abs() < 1e-14, "{length}");
            }
        }
    }
}

//! The singular value decomposition of a record's Hankel matrix, as much of it as is asked for.

use crumple_numerics::linalg::jacobi_svd;
use nalgebra::{DMatrix, SymmetricEigen};

use crate::EraError;
use crate::error::RANK_TOLERANCE;
use crate::hankel::golub_kahan::GolubKahan;
use crate::hankel::shift_pair::ShiftPair;

/// Up to this many rows (or columns) the matrix is formed and decomposed whole, all singular values, in about 1 ms.
/// Beyond, the cost grows with the cube (measured for the square case: 5 ms at 200, 0.2 s at 600) while Lanczos stays
/// near 1 ms.
const DENSE_UP_TO: usize = 64;

/// Lanczos steps at which convergence is looked at; the last is the limit.
const CHECKPOINTS: [usize; 9] = [8, 12, 18, 27, 40, 60, 90, 135, 200];

/// QR steps per eigenvalue before a symmetric matrix counts as stuck; two are usual.
const EIGEN_STEPS_PER_VALUE: usize = 60;

/// Steps after which nothing more is done for singular values that are only evidence. Those in a plateau of noise come
/// in near-equal pairs and would take hundreds.
const EVIDENCE_STEPS: usize = 27;

/// The same where the order is chosen from them.
const CHOICE_STEPS: usize = 90;

/// Largest matrix, in entries, that is formed when Lanczos does not converge: 32 MB, seconds to a minute.
const DENSE_FALLBACK: usize = 4_000_000;

/// Residual, relative to the largest singular value, of triplets that a model is built from.
const EXACT: f64 = 1e-12;

/// Residual, relative to the largest, of singular values that are reported: it bounds their error.
const REPORTED: f64 = 1e-9;

/// Relative residual of singular values good enough to see a gap between them.
const SEEN: f64 = 0.03;

/// How the decomposition was computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decomposition {
    /// Matrix formed, all singular values.
    Dense,
    /// Golub-Kahan-Lanczos with FFT products, the leading ones only.
    Lanczos {
        /// Steps taken.
        steps: usize,
    },
}

/// Leading singular triplets of `H0`, largest value first, with the sign convention of [`fix_signs`].
pub(crate) struct Factors {
    /// Converged singular values.
    pub(crate) values: Vec<f64>,
    /// Leading singular values good enough to look at, with bounds of their errors: the converged ones and those that
    /// follow with an error of at most [`SEEN`] of themselves.
    pub(crate) seen: Vec<(f64, f64)>,
    /// Left vectors as columns, for at least as many values as models need.
    pub(crate) left: DMatrix<f64>,
    /// Right vectors as columns.
    pub(crate) right: DMatrix<f64>,
    /// How they were computed.
    pub(crate) decomposition: Decomposition,
}

impl Factors {
    /// Number of singular values above rounding.
    pub(crate) fn rank(&self) -> usize {
        rank(&self.values)
    }
}

/// Decomposes `H0`.
///
/// `needed` tells from the leading singular values seen so far how many triplets must be exact; `evidence` is the
/// number of values one would like to see, and waits for longer with `patient`. Errors: [`EraError::NotConverged`].
pub(crate) fn factorize(
    h: &mut impl ShiftPair,
    evidence: usize,
    patient: bool,
    needed: impl Fn(&[f64]) -> usize,
) -> Result<Factors, EraError> {
    let size = h.rows().min(h.columns());
    if size <= DENSE_UP_TO {
        return dense(h);
    }
    let mut lanczos = GolubKahan::new(h.columns());
    for steps in CHECKPOINTS {
        lanczos.extend(h, steps);
        let Some(ritz) = lanczos.ritz() else { break };
        let largest = ritz.values.first().copied().unwrap_or(0.0);
        let leading = |good: &dyn Fn(f64, f64) -> bool| {
            ritz.values.iter().zip(&ritz.residuals).take_while(|(s, r)| good(**s, **r)).count()
        };
        let exact = leading(&|_, residual| residual <= EXACT * largest);
        let seen = leading(&|value, residual| residual <= (SEEN * value).max(EXACT * largest));
        let finished = lanczos.exhausted();
        let patience = if patient { CHOICE_STEPS } else { EVIDENCE_STEPS };
        if !finished && seen < evidence.min(size) && lanczos.steps() < patience {
            continue;
        }
        // Values after a converged one below the rank tolerance are rounding too.
        if finished || exact >= needed(&ritz.values[..seen]) || rank(&ritz.values[..exact]) < exact {
            let reported = leading(&|_, residual| residual <= REPORTED * largest);
            let (mut left, mut right) = lanczos.vectors(&ritz, exact);
            fix_signs(&mut left, &mut right);
            let shown = reported.max(seen.min(evidence));
            return Ok(Factors {
                values: ritz.values[..reported].to_vec(),
                seen: ritz.values.iter().copied().zip(ritz.residuals.iter().copied()).take(shown).collect(),
                left,
                right,
                decomposition: Decomposition::Lanczos { steps: lanczos.steps() },
            });
        }
    }
    if h.rows() * h.columns() <= DENSE_FALLBACK {
        return dense(h);
    }
    Err(EraError::NotConverged { rows: h.rows(), columns: h.columns(), steps: lanczos.steps() })
}

/// Forms the matrix and decomposes it whole.
///
/// The Hankel matrix of one channel is symmetric when it is square: `H = Q L Q'`, so `S = |L|`, `U = Q`,
/// `V = Q sign(L)`, at a fraction of the cost of an SVD. Otherwise a QR step first makes it square.
fn dense(h: &mut impl ShiftPair) -> Result<Factors, EraError> {
    let (rows, columns) = (h.rows(), h.columns());
    let steps = EIGEN_STEPS_PER_VALUE * rows.min(columns);
    let failed = || EraError::NotConverged { rows, columns, steps };
    let (values, mut left, mut right): (Vec<f64>, _, _) = if h.symmetric() {
        let eigen = SymmetricEigen::try_new(h.dense(), f64::EPSILON, steps).ok_or_else(failed)?;
        let mut order: Vec<usize> = (0..rows).collect();
        order.sort_by(|&i, &j| eigen.eigenvalues[j].abs().total_cmp(&eigen.eigenvalues[i].abs()));
        let vectors = eigen.eigenvectors.select_columns(&order);
        let mut right = vectors.clone();
        for (mut column, &i) in right.column_iter_mut().zip(&order) {
            column *= 1.0_f64.copysign(eigen.eigenvalues[i]);
        }
        (order.iter().map(|&i| eigen.eigenvalues[i].abs()).collect(), vectors, right)
    } else {
        let wide = columns > rows;
        let (q, r) = if wide { h.dense().transpose() } else { h.dense() }.qr().unpack();
        let svd = jacobi_svd(&r).ok_or_else(failed)?;
        let tall_side = q * svd.left;
        if wide { (svd.values, svd.right, tall_side) } else { (svd.values, tall_side, svd.right) }
    };
    fix_signs(&mut left, &mut right);
    let rounding = f64::EPSILON * values.first().copied().unwrap_or(0.0);
    let seen = values.iter().map(|s| (*s, rounding)).collect();
    Ok(Factors { values, seen, left, right, decomposition: Decomposition::Dense })
}

/// Number of leading values above [`RANK_TOLERANCE`] times the first.
fn rank(values: &[f64]) -> usize {
    let tolerance = values.first().copied().unwrap_or(0.0) * RANK_TOLERANCE;
    values.iter().take_while(|s| **s > tolerance).count()
}

/// Makes the entry of largest magnitude of every left vector positive (the first such entry on a tie), and flips the
/// right vector with it: the signs of singular vectors are free, the model's should not be.
fn fix_signs(left: &mut DMatrix<f64>, right: &mut DMatrix<f64>) {
    for i in 0..left.ncols().min(right.ncols()) {
        let largest = left.column(i).iter().fold(0.0_f64, |best, x| if x.abs() > best.abs() { *x } else { best });
        if largest < 0.0 {
            left.column_mut(i).neg_mut();
            right.column_mut(i).neg_mut();
        }
    }
}

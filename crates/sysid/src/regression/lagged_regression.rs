//! Regression of signals on their own past and that of others.
//!
//! Regressions of this kind have columns that are shifted copies of few signals: ARX, observers, impulse responses.
//! Their inner products then cost `O(rows)` for one column of each pair of signals and `O(1)` for every other, where
//! QR costs `O(rows columns²)`. What sums of products lose in digits (the condition number is squared) two
//! corrections give back.

use crumple_numerics::linalg::dot;
use nalgebra::DMatrix;

use crate::IdentifyError;
use crate::regression::data_triangle::triangular_factor;
use crate::regression::shifted_products::shifted_products;

/// A pivot of the Cholesky factor (column norms 1) below which sums of products are not trusted: columns within 1e-4 of
/// dependent, condition number about 1e5.
const SAFE_PIVOT: f64 = 1e-8;

/// Corrections of the solution from the residuals; each gains as many digits as sums of products have, eight at least.
const CORRECTIONS: usize = 2;

/// `targets[k]` regressed on columns `signal[offset + k]`, `k = 0..rows`.
pub(crate) struct LaggedRegression<'a> {
    /// Signals of comparable size.
    pub(crate) signals: Vec<&'a [f64]>,
    /// Signal and offset of every column, targets last.
    pub(crate) columns: Vec<(usize, usize)>,
    /// Number of targets.
    pub(crate) targets: usize,
    /// Number of rows.
    pub(crate) rows: usize,
}

/// What [`LaggedRegression::solve`] found.
pub(crate) struct LaggedSolution {
    /// One column per target.
    pub(crate) coefficients: DMatrix<f64>,
    /// Numerical rank of the regressors; less than their number where they are collinear.
    pub(crate) rank: usize,
    /// `squares[n]`: sums of squared residuals of every target, from the first `n` regressors alone.
    pub(crate) squares: Vec<Vec<f64>>,
}

impl LaggedRegression<'_> {
    /// The samples of one column.
    fn stretch(&self, column: usize) -> &[f64] {
        let (signal, offset) = self.columns[column];
        &self.signals[signal][offset..offset + self.rows]
    }

    /// Number of columns without the targets.
    fn regressors(&self) -> usize {
        self.columns.len() - self.targets
    }

    /// Solves by least squares, singular values below `truncation` of the largest left out.
    ///
    /// Columns are shifted copies, so that their inner products follow from one another in `O(1)`: where no column is
    /// close to a combination of others (and no target), a Cholesky factor of these sums leads to a solution that is
    /// corrected twice from its residuals over the data, to the accuracy of QR. Everywhere else QR of the whole.
    pub(crate) fn solve(&self, truncation: f64) -> Result<LaggedSolution, IdentifyError> {
        if let Some(solution) = self.by_products() {
            return Ok(solution);
        }
        let stretches: Vec<(&[f64], usize)> =
            self.columns.iter().map(|(signal, offset)| (self.signals[*signal], *offset)).collect();
        let factor = triangular_factor(&stretches, self.rows);
        let r = factor.matrix();
        let solution = factor
            .solve(self.targets, truncation)
            .ok_or(IdentifyError::NotConverged("the least-squares fit of the observer"))?;
        let p = self.regressors();
        let squares = (0..=p)
            .map(|n| (0..self.targets).map(|t| r.column(p + t).iter().skip(n).map(|x| x * x).sum()).collect())
            .collect();
        Ok(LaggedSolution { coefficients: solution.coefficients, rank: solution.rank, squares })
    }

    /// `None` where sums of products would lose too many digits.
    ///
    /// Cholesky factorisation of the Gram matrix of columns of norm 1, then two steps of iterative refinement with
    /// residuals from the data themselves. Refused below [`SAFE_PIVOT`], also for a target that the regressors
    /// explain to that extent: its residual would be a difference of near-equal sums.
    fn by_products(&self) -> Option<LaggedSolution> {
        let p = self.regressors();
        let gram = shifted_products(&self.signals, &self.columns, self.rows);
        let norms: Vec<f64> = (0..gram.nrows()).map(|j| gram[(j, j)].max(0.0).sqrt()).collect();
        if norms.iter().any(|norm| !(*norm > 0.0 && norm.is_finite())) {
            return None;
        }
        let scaled = DMatrix::from_fn(gram.nrows(), gram.ncols(), |i, j| gram[(i, j)] / (norms[i] * norms[j]));
        // Lower factor, regressors only; of the targets what is left after each.
        let mut lower = DMatrix::<f64>::zeros(p + self.targets, p);
        let mut left: Vec<f64> = vec![1.0; p + self.targets];
        let mut squares = vec![(0..self.targets).map(|t| norms[p + t].powi(2)).collect::<Vec<f64>>()];
        for j in 0..p {
            if left[j] < SAFE_PIVOT {
                return None;
            }
            let pivot = left[j].sqrt();
            let mut column: Vec<f64> = (j..p + self.targets).map(|i| scaled[(i, j)]).collect();
            for k in 0..j {
                let factor = lower[(j, k)];
                for (x, l) in column.iter_mut().zip(lower.column(k).iter().skip(j)) {
                    *x -= factor * l;
                }
            }
            for (i, x) in (j..).zip(column) {
                let entry = if i == j { pivot } else { x / pivot };
                lower[(i, j)] = entry;
                left[i] -= entry * entry;
            }
            squares.push((p..p + self.targets).map(|i| left[i].max(0.0) * norms[i] * norms[i]).collect());
        }
        if left[p..].iter().any(|rest| *rest < SAFE_PIVOT) {
            return None;
        }
        let solve = |rhs: &mut Vec<f64>| {
            for j in 0..p {
                rhs[j] /= lower[(j, j)];
                let x = rhs[j];
                for (i, value) in rhs.iter_mut().enumerate().skip(j + 1) {
                    *value -= lower[(i, j)] * x;
                }
            }
            for j in (0..p).rev() {
                let below: f64 = (j + 1..p).map(|i| lower[(i, j)] * rhs[i]).sum();
                rhs[j] = (rhs[j] - below) / lower[(j, j)];
            }
        };
        let mut coefficients = DMatrix::zeros(p, self.targets);
        for t in 0..self.targets {
            let mut x: Vec<f64> = (0..p).map(|j| scaled[(p + t, j)] * norms[p + t]).collect();
            solve(&mut x);
            for _ in 0..CORRECTIONS {
                let mut residual = self.stretch(p + t).to_vec();
                for (j, x) in x.iter().enumerate() {
                    let factor = x / norms[j];
                    for (r, v) in residual.iter_mut().zip(self.stretch(j)) {
                        *r -= factor * v;
                    }
                }
                let mut step: Vec<f64> = (0..p).map(|j| dot(self.stretch(j), &residual) / norms[j]).collect();
                solve(&mut step);
                for (x, step) in x.iter_mut().zip(step) {
                    *x += step;
                }
            }
            for (j, x) in x.iter().enumerate() {
                coefficients[(j, t)] = x / norms[j];
            }
        }
        coefficients.iter().all(|x| x.is_finite()).then_some(LaggedSolution { coefficients, rank: p, squares })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::estimation::random::uniform_at;

    fn regression(signals: &[Vec<f64>], lags: usize) -> LaggedRegression<'_> {
        let mut columns = vec![(0, lags)];
        for lag in 1..=lags {
            columns.extend([(0, lags - lag), (1, lags - lag)]);
        }
        columns.push((1, lags));
        let rows = signals[0].len() - lags;
        LaggedRegression { signals: signals.iter().map(Vec::as_slice).collect(), columns, targets: 1, rows }
    }

    /// An answer with two poles to white noise, with noise of its own.
    fn signals(noise: f64) -> Vec<Vec<f64>> {
        let u: Vec<f64> = (0..600).map(|k| uniform_at(1, k) - 0.5).collect();
        let mut y = vec![0.0; 600];
        for k in 2..600 {
            y[k] = 1.6 * y[k - 1] - 0.8 * y[k - 2] + u[k - 1] + noise * (uniform_at(2, k) - 0.5);
        }
        vec![u, y]
    }

    #[test]
    fn sums_of_products_give_the_solution_of_qr() {
        let signals = signals(0.3);
        let regression = regression(&signals, 8);
        let fast = regression.by_products().unwrap();
        let stretches: Vec<(&[f64], usize)> = regression.columns.iter().map(|(s, o)| (&signals[*s][..], *o)).collect();
        let exact = triangular_factor(&stretches, regression.rows).solve(1, 0.0).unwrap();
        // Condition number about 30: rounding.
        assert!((&fast.coefficients - &exact.coefficients).amax() < 1e-13);
        assert!((fast.squares[17][0] / exact.residual_squares[0] - 1.0).abs() < 1e-11);
        assert_eq!((fast.rank, fast.squares.len()), (17, 18));
    }

    #[test]
    fn data_without_noise_are_left_to_qr_whose_rank_tells() {
        let signals = signals(0.0);
        let regression = regression(&signals, 8);
        assert!(regression.by_products().is_none());
        let solution = regression.solve(1e-10).unwrap();
        // Two equations tie every third lag to the two before: the input's columns and two of the output are free.
        assert_eq!(solution.rank, 9 + 2);
        assert!(solution.squares[17][0] < 1e-20 * solution.squares[0][0]);
    }
}

//! Tall least-squares problems by orthogonal transformations, without holding the whole matrix.

use crumple_lti::{dot, jacobi_svd};
use nalgebra::DMatrix;

/// Condition number of the column-scaled equations above which a solution is refused.
pub const CONDITION_LIMIT: f64 = 1e12;

/// The triangular factor of a tall matrix that arrives in blocks of rows.
///
/// Householder reflections of `[R; block]`, one column of the block at a time: the same backward error as one QR of the
/// whole, and no normal equations. Cost `2 rows columns²`; memory one block.
#[derive(Debug, Clone)]
pub(crate) struct TriangularFactor {
    columns: usize,
    rows: usize,
    /// Upper triangle, column after column.
    r: Vec<f64>,
}

impl TriangularFactor {
    /// Of a matrix without rows so far.
    pub(crate) fn new(columns: usize) -> Self {
        Self { columns, rows: 0, r: vec![0.0; columns * columns] }
    }

    /// Number of rows per block that stays in the cache.
    pub(crate) fn block_rows(columns: usize) -> usize {
        (16_384 / columns.max(1)).clamp(64, 1024)
    }

    /// Adds the rows of a block: `rows` entries of the first column, then of the second, ... The block is destroyed.
    pub(crate) fn push(&mut self, rows: usize, block: &mut [f64]) {
        let p = self.columns;
        debug_assert_eq!(block.len(), rows * p);
        self.rows += rows;
        for j in 0..p {
            let (done, rest) = block.split_at_mut((j + 1) * rows);
            let x = &done[j * rows..];
            let sigma = dot(x, x);
            if sigma == 0.0 {
                continue;
            }
            let alpha = self.r[j * p + j];
            let norm = alpha.hypot(sigma.sqrt());
            let beta = if alpha > 0.0 { -norm } else { norm };
            let v0 = alpha - beta;
            let factor = 2.0 / (v0 * v0 + sigma);
            self.r[j * p + j] = beta;
            for (k, column) in rest.chunks_exact_mut(rows).enumerate() {
                let top = &mut self.r[(j + 1 + k) * p + j];
                let s = factor * (*top * v0 + dot(x, column));
                *top -= s * v0;
                for (c, x) in column.iter_mut().zip(x) {
                    *c -= s * x;
                }
            }
        }
    }

    /// Adds the rows that another factor stands for.
    pub(crate) fn merge(&mut self, other: &Self) {
        debug_assert_eq!(self.columns, other.columns);
        let rows = self.rows + other.rows;
        let mut block = other.r.clone();
        self.push(self.columns, &mut block);
        self.rows = rows;
    }

    /// Number of rows taken so far.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// The factor as a matrix.
    pub(crate) fn matrix(&self) -> DMatrix<f64> {
        DMatrix::from_column_slice(self.columns, self.columns, &self.r)
    }

    /// Solves for the last `targets` columns in terms of the others.
    ///
    /// Columns are scaled to norm 1, then a singular value decomposition of the triangle tells the condition number.
    /// Singular values below `truncation` of the largest count as zero (the solution of least norm in scaled columns).
    /// `None` if the decomposition does not settle or a column is not finite.
    pub(crate) fn solve(&self, targets: usize, truncation: f64) -> Option<Solution> {
        let p = self.columns - targets;
        let r = self.matrix();
        if r.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let norms: Vec<f64> =
            (0..p).map(|j| r.column(j).norm()).map(|norm| if norm > 0.0 { norm } else { 1.0 }).collect();
        let scaled = DMatrix::from_fn(p, p, |i, j| r[(i, j)] / norms[j]);
        let svd = jacobi_svd(&scaled)?;
        let largest = svd.values.first().copied().unwrap_or(0.0);
        let rank = svd.values.iter().take_while(|s| **s > truncation * largest && **s > 0.0).count();
        let smallest = svd.values.last().copied().unwrap_or(0.0);
        let mut coefficients = DMatrix::zeros(p, targets);
        let mut residual_squares = Vec::with_capacity(targets);
        for t in 0..targets {
            let rhs: Vec<f64> = r.column(p + t).iter().copied().collect();
            let mut missed = dot(&rhs[p..], &rhs[p..]);
            for i in 0..p {
                let part = dot(svd.left.column(i).as_slice(), &rhs[..p]);
                if i < rank {
                    for j in 0..p {
                        coefficients[(j, t)] += svd.right[(j, i)] * part / svd.values[i] / norms[j];
                    }
                } else {
                    missed += part * part;
                }
            }
            residual_squares.push(missed);
        }
        let inverse_square = DMatrix::from_fn(p, p, |i, j| {
            (0..rank).map(|k| svd.right[(i, k)] * svd.right[(j, k)] / (svd.values[k] * svd.values[k])).sum::<f64>()
                / (norms[i] * norms[j])
        });
        Some(Solution {
            coefficients,
            residual_squares,
            rank,
            condition: if smallest > 0.0 { largest / smallest } else { f64::INFINITY },
            inverse_square,
        })
    }
}

/// What [`TriangularFactor::solve`] found.
#[derive(Debug, Clone)]
pub(crate) struct Solution {
    /// One column per target.
    pub(crate) coefficients: DMatrix<f64>,
    /// Sum of squared residuals of every target.
    pub(crate) residual_squares: Vec<f64>,
    /// Number of singular values that count.
    pub(crate) rank: usize,
    /// Condition number of the column-scaled equations, before truncation.
    pub(crate) condition: f64,
    /// `(X' X)⁻¹`, to be multiplied by the noise variance.
    pub(crate) inverse_square: DMatrix<f64>,
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    fn entry(i: usize, j: usize) -> f64 {
        ((i * 7 + j * 13) as f64 * 0.37).sin() + if i == j { 2.0 } else { 0.0 }
    }

    #[test]
    fn blocks_give_the_solution_of_the_whole() {
        let exact = [1.5, -2.0, 0.25];
        let mut factor = TriangularFactor::new(4);
        for block in 0..7 {
            let rows = 11;
            let mut data = vec![0.0; 4 * rows];
            for i in 0..rows {
                let x: Vec<f64> = (0..3).map(|j| entry(block * rows + i, j)).collect();
                for j in 0..3 {
                    data[j * rows + i] = x[j];
                }
                data[3 * rows + i] = dot(&x, &exact);
            }
            factor.push(rows, &mut data);
        }
        let solution = factor.solve(1, 0.0).unwrap();
        assert_eq!(factor.rows(), 77);
        for (found, exact) in solution.coefficients.iter().zip(exact) {
            // Rounding of a well-conditioned problem.
            assert!((found - exact).abs() < 1e-13, "{found} {exact}");
        }
        assert!(solution.residual_squares[0] < 1e-25 && solution.condition < 10.0);
    }

    #[test]
    fn merged_factors_stand_for_all_rows() {
        let rows = 20;
        let data: Vec<f64> = (0..3).flat_map(|j| (0..rows).map(move |i| entry(i, j))).collect();
        let mut whole = TriangularFactor::new(3);
        whole.push(rows, &mut data.clone());
        let half = |first: usize| {
            let mut part: Vec<f64> = (0..3).flat_map(|j| (first..first + 10).map(move |i| entry(i, j))).collect();
            let mut factor = TriangularFactor::new(3);
            factor.push(10, &mut part);
            factor
        };
        let mut merged = half(0);
        merged.merge(&half(10));
        let (a, b) = (whole.matrix(), merged.matrix());
        // R is unique up to signs of its rows.
        assert!((a.map(f64::abs) - b.map(f64::abs)).amax() < 1e-13);
        assert_eq!(merged.rows(), 20);
    }

    #[test]
    fn equal_columns_are_truncated_and_reported() {
        let rows = 30;
        let mut data: Vec<f64> = [0, 0, 1].iter().flat_map(|&j| (0..rows).map(move |i| entry(i, j))).collect();
        let mut factor = TriangularFactor::new(3);
        factor.push(rows, &mut data);
        let solution = factor.solve(1, 1e-12).unwrap();
        assert!(solution.condition > 1e14);
        // The least-norm solution shares the weight equally.
        assert!((solution.coefficients[0] - solution.coefficients[1]).abs() < 1e-14);
    }
}

//! Block Hankel matrices of data correlations that are multiplied without being formed.

use nalgebra::DMatrix;

use crate::hankel::block_hankel::Hankel;
use crate::hankel::shift_pair::{Shift, ShiftPair};

/// Sizes of a matrix of data correlations, in blocks of one sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct CorrelationSize {
    /// Rows of the Hankel matrices that are correlated.
    pub(crate) rows: usize,
    /// Their columns, over which the correlation sums.
    pub(crate) columns: usize,
    /// Lag of the first correlation.
    pub(crate) offset: usize,
    /// Correlations stacked beyond the first, each way.
    pub(crate) lag_blocks: usize,
}

impl CorrelationSize {
    /// Markov parameters after the direct term that the pair holds.
    pub(crate) fn parameters(&self) -> usize {
        self.lag_blocks
            .saturating_mul(2)
            .saturating_add(self.rows)
            .saturating_add(self.columns)
            .saturating_add(self.offset)
    }
}

/// The pair `[Hc(o+i+j)]` and `[Hc(o+i+j+1)]`, `i, j = 0..=lag blocks`, of `Hc(k) = H_k H_0'`, `H_k` the Hankel matrix
/// that starts `k` samples after `H_0`.
///
/// The stacked `H_(o+i+j)` repeat one another: the sum over `j` is a single Hankel product of overlapping columns, and
/// the rows of every `i` are a stretch of its result. So a product costs a few FFTs for every lag block, memory `O(N)`
/// each.
pub(crate) struct Correlations<'a> {
    /// `H_0`.
    first: Hankel<'a>,
    /// From the offset on, larger by the lag blocks each way.
    /// The larger matrix that holds all `H_(o+i+j)` at once: block row `i`, block column `j` start there `i` and `j`
    /// blocks later.
    late: Hankel<'a>,
    size: CorrelationSize,
    outputs: usize,
    inputs: usize,
    /// Vectors between the two products, kept so that a product allocates nothing.
    rows_scratch: Vec<f64>,
    columns_scratch: Vec<f64>,
    part: Vec<f64>,
}

impl<'a> Correlations<'a> {
    /// `y[r * inputs + c]` starts with the first Markov parameter after the direct term and holds
    /// [`CorrelationSize::parameters`] of them. The caller has checked the lengths.
    pub(crate) fn new(y: &[&'a [f64]], inputs: usize, size: CorrelationSize) -> Self {
        let outputs = y.len() / inputs;
        let (rows, columns) = (size.rows + size.lag_blocks, size.columns + size.lag_blocks);
        Self {
            first: Hankel::new(y.to_vec(), inputs, size.rows, size.columns),
            late: Hankel::new(y.iter().map(|y| &y[size.offset..]).collect(), inputs, rows, columns),
            outputs,
            inputs,
            rows_scratch: vec![0.0; rows * outputs],
            columns_scratch: vec![0.0; columns * inputs],
            part: vec![0.0; size.columns * inputs],
            size,
        }
    }

    /// `H_0`, for what is needed of it beside its correlations.
    pub(crate) fn first(&mut self) -> &mut Hankel<'a> {
        &mut self.first
    }

    /// Rows of one correlation block: block rows times outputs.
    fn block(&self) -> usize {
        self.size.rows * self.outputs
    }
}

impl ShiftPair for Correlations<'_> {
    fn rows(&self) -> usize {
        self.block() * (self.size.lag_blocks + 1)
    }

    fn columns(&self) -> usize {
        self.rows()
    }

    fn symmetric(&self) -> bool {
        false
    }

    /// `sum_j H_(o+i+j) H_0' x_j` for every `i`: one transposed product with `H_0` per lag block, summed at its own
    /// place, then one product with the larger matrix, whose result is read at every `i`.
    fn multiply(&mut self, shift: Shift, x: &[f64], out: &mut [f64]) {
        let block = self.block();
        self.columns_scratch.fill(0.0);
        for (j, x) in x.chunks_exact(block).enumerate() {
            self.first.multiply_transposed(Shift::Zero, x, &mut self.part);
            for (sum, part) in self.columns_scratch[j * self.inputs..].iter_mut().zip(&self.part) {
                *sum += part;
            }
        }
        self.late.multiply(shift, &self.columns_scratch, &mut self.rows_scratch);
        for (i, out) in out.chunks_exact_mut(block).enumerate() {
            out.copy_from_slice(&self.rows_scratch[i * self.outputs..][..block]);
        }
    }

    /// The same backwards: `out_j = H_0 sum_i H_(o+i+j)' x_i`.
    fn multiply_transposed(&mut self, shift: Shift, x: &[f64], out: &mut [f64]) {
        let block = self.block();
        self.rows_scratch.fill(0.0);
        for (i, x) in x.chunks_exact(block).enumerate() {
            for (sum, x) in self.rows_scratch[i * self.outputs..].iter_mut().zip(x) {
                *sum += x;
            }
        }
        self.late.multiply_transposed(shift, &self.rows_scratch, &mut self.columns_scratch);
        for (j, out) in out.chunks_exact_mut(block).enumerate() {
            let stretch = &self.columns_scratch[j * self.inputs..][..self.part.len()];
            self.first.multiply(Shift::Zero, stretch, out);
        }
    }

    /// Column after column by products with unit vectors; for tests and small matrices.
    fn dense(&mut self) -> DMatrix<f64> {
        let n = self.rows();
        let mut matrix = DMatrix::zeros(n, n);
        let (mut unit, mut column) = (vec![0.0; n], vec![0.0; n]);
        for j in 0..n {
            unit[j] = 1.0;
            self.multiply(Shift::Zero, &unit, &mut column);
            unit[j] = 0.0;
            matrix.column_mut(j).copy_from_slice(&column);
        }
        matrix
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_equal_those_of_the_formed_correlations() {
        for (q, m, rows, columns, offset, lag_blocks) in [(1, 1, 4, 9, 0, 0), (1, 1, 5, 12, 3, 2), (3, 2, 4, 11, 1, 3)]
        {
            let size = CorrelationSize { rows, columns, offset, lag_blocks };
            let y: Vec<Vec<f64>> = (0..q * m)
                .map(|s| (0..size.parameters()).map(|k| (k as f64 * 0.7 + s as f64).sin() + 0.1 * s as f64).collect())
                .collect();
            let hankel =
                |k: usize| DMatrix::from_fn(rows * q, columns * m, |i, j| y[(i % q) * m + j % m][i / q + j / m + k]);
            let mut pair = Correlations::new(&y.iter().map(Vec::as_slice).collect::<Vec<_>>(), m, size);
            let n = pair.rows();
            let x: Vec<f64> = (0..n).map(|k| (k as f64 * 1.3).cos()).collect();
            for (shift, late) in [(Shift::Zero, 0), (Shift::One, 1)] {
                let mut stacked = DMatrix::zeros(n, n);
                for i in 0..=lag_blocks {
                    for j in 0..=lag_blocks {
                        let lagged = hankel(offset + i + j + late) * hankel(0).transpose();
                        stacked.view_mut((i * rows * q, j * rows * q), (rows * q, rows * q)).copy_from(&lagged);
                    }
                }
                let (mut out, mut out_t) = (vec![0.0; n], vec![0.0; n]);
                pair.multiply(shift, &x, &mut out);
                pair.multiply_transposed(shift, &x, &mut out_t);
                let factor = DMatrix::from_column_slice(n, 1, &x);
                let exact = &stacked * &factor;
                let exact_t = stacked.transpose() * &factor;
                for (estimated, expected) in out.iter().chain(&out_t).zip(exact.iter().chain(exact_t.iter())) {
                    // Sums of up to 500 terms of size 1: some hundred rounding units of them.
                    assert!((estimated - expected).abs() < 1e-11, "{size:?}: {estimated} against {expected}");
                }
                if shift == Shift::Zero {
                    assert!((pair.dense() - &stacked).amax() < 1e-12);
                }
            }
        }
    }
}

//! Pairs of matrices one sample apart that are known by their products with vectors only.

use nalgebra::DMatrix;

/// Which matrix of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shift {
    /// The matrix that is decomposed.
    Zero,
    /// The same, one sample later.
    One,
}

/// A matrix of samples and the same matrix one sample later: what a realisation is read from.
///
/// Large ones are multiplied without being formed, which may need scratch space: hence `&mut self`.
///
/// With `H0 = O C` (observability times controllability) the shifted one is `H1 = O A C`: the state matrix is all
/// that stands between them.
pub(crate) trait ShiftPair {
    /// Rows.
    fn rows(&self) -> usize;
    /// Columns.
    fn columns(&self) -> usize;
    /// Whether the first of the pair equals its transpose.
    fn symmetric(&self) -> bool;
    /// `out = H x`.
    fn multiply(&mut self, shift: Shift, x: &[f64], out: &mut [f64]);
    /// `out = H' x`.
    fn multiply_transposed(&mut self, shift: Shift, x: &[f64], out: &mut [f64]);
    /// The first of the pair, entry by entry.
    fn dense(&mut self) -> DMatrix<f64>;
}

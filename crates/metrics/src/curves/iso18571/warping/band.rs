//! Two curves, the band of their table, and which cells of it can reach a path.

use pulp::Arch;

/// Fronts kept of a stretch of diagonals.
pub(super) const KEPT: usize = 64;

/// Up to this many diagonals every cell that can reach the path is kept: half of 512² numbers, 1 MB.
pub(super) const TRIANGLE: usize = 512;

/// Two curves and what is left out of their table.
pub struct Warping<'a> {
    pub(super) c: &'a [f64],
    /// T from its end, so that along a diagonal both curves are read upwards.
    pub(super) t_reversed: Vec<f64>,
    pub(super) band: usize,
    /// The least path costs no more.
    pub(super) highest: f64,
    /// See [`KEPT`].
    pub(super) kept: usize,
    /// See [`TRIANGLE`].
    pub(super) triangle: usize,
    /// The widest vectors of this processor.
    pub(super) arch: Arch,
}

impl<'a> Warping<'a> {
    /// Curves of one length that is not zero; `highest`: a cost that the least path does not exceed.
    pub(super) fn with_limit(t: &[f64], c: &'a [f64], band: usize, highest: f64) -> Self {
        Self {
            c,
            t_reversed: t.iter().rev().copied().collect(),
            band,
            highest,
            kept: KEPT,
            triangle: TRIANGLE,
            arch: Arch::new(),
        }
    }

    /// The cell of both ends.
    pub(super) fn end(&self) -> (usize, usize) {
        (self.c.len() - 1, self.c.len() - 1)
    }

    /// i from..to on diagonal k inside band and table, as far as the path can come from there to cell `end`.
    pub(super) fn range(&self, k: usize, end: (usize, usize)) -> (usize, usize) {
        let (i, j) = end;
        let from = k.saturating_sub(self.band).div_ceil(2).max(k.saturating_sub(j));
        let to = ((k + self.band) / 2).min(k).min(i) + 1;
        (from, to)
    }

    /// T along diagonal k from i on.
    pub(super) fn t_from(&self, k: usize, i: usize) -> &[f64] {
        &self.t_reversed[self.c.len() - 1 + i - k..]
    }
}

//! Several diagonals of a stretch of i at once, in memory that stays in the cache.
//!
//! A tile is some hundred diagonals of a thousand cells: its working memory fits the first cache, and each diagonal is
//! one loop without dependencies between its cells. Tiles of a row hand on the costs at their border through
//! [`Buffers`].

use pulp::{Simd, WithSimd};

use crate::curves::iso18571::warping::band::Warping;
use crate::curves::iso18571::warping::cells::accumulate;

/// What tiles of one row of tiles hand on, and their working memory.
pub(super) struct Buffers {
    /// Costs of the cell before the tile on diagonals `k - 1`, `k`, `k + 1`, ...
    column: Vec<f64>,
    /// Three diagonals of a tile, each with the cell before it.
    diagonals: [Vec<f64>; 3],
}

impl Buffers {
    /// Empty; filled by [`start_row`](Self::start_row).
    pub(super) fn new() -> Self {
        Self { column: Vec::new(), diagonals: std::array::from_fn(|_| vec![0.0; Tile::WIDTH + 1]) }
    }

    /// Before the first tile: the cell at `index` of the two diagonals, and nothing on those to come.
    pub(super) fn start_row(&mut self, before: &[f64], last: &[f64], index: usize, rows: usize) {
        self.column.clear();
        self.column.extend([before[index], last[index]]);
        self.column.resize(rows + 2, f64::INFINITY);
    }
}

/// Cells `first`.. of the diagonals after k, one for each range of i.
pub(super) struct Tile<'a> {
    pub(super) k: usize,
    pub(super) first: usize,
    /// i from..to that each of the diagonals has.
    pub(super) ranges: &'a [(usize, usize)],
}

impl Tile<'_> {
    /// Cells side by side: three diagonals and two curves fill a first-level cache of 48 KiB.
    pub(super) const WIDTH: usize = 1024;

    /// From diagonals `k - 1` and `k` the last two of the tile, in their place.
    pub(super) fn fill(&self, warping: &Warping, before: &mut [f64], last: &mut [f64], buffers: &mut Buffers) {
        let width = before.len();
        let Buffers { column, diagonals } = buffers;
        for (row, cells) in [&mut *before, &mut *last].into_iter().enumerate() {
            diagonals[row][0] = std::mem::replace(&mut column[row], cells[width - 1]);
            diagonals[row][1..=width].copy_from_slice(cells);
        }
        let [a, b, c] = diagonals;
        let rows = [&mut a[..=width], &mut b[..=width], &mut c[..=width]];
        warping.arch.dispatch(Sweep { warping, tile: self, column, rows });
        let steps = self.ranges.len();
        before.copy_from_slice(&diagonals[steps % 3][1..=width]);
        last.copy_from_slice(&diagonals[(steps + 1) % 3][1..=width]);
    }
}

/// The work of one tile, compiled for each width of vectors.
struct Sweep<'a> {
    warping: &'a Warping<'a>,
    tile: &'a Tile<'a>,
    column: &'a mut [f64],
    rows: [&'a mut [f64]; 3],
}

impl WithSimd for Sweep<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { warping, tile, column, rows: [mut before, mut last, mut next] } = self;
        let (first, end) = (tile.first, tile.first + next.len() - 1);
        for (row, &(from, to)) in tile.ranges.iter().enumerate() {
            let k = tile.k + 1 + row;
            let from = from.clamp(first, end);
            let to = to.clamp(from, end);
            let (low, high) = (from - first, to - first);
            next[0] = column[row + 2];
            next[1..=low].fill(f64::INFINITY);
            next[high + 1..].fill(f64::INFINITY);
            if low < high {
                let t = warping.t_from(k, from);
                let (up, left, corner) = (&last[low..high], &last[low + 1..=high], &before[low..high]);
                accumulate(&warping.c[from..to], t, up, left, corner, &mut next[low + 1..=high]);
            }
            column[row + 2] = next[end - first];
            (before, last, next) = (last, next, before);
        }
    }
}

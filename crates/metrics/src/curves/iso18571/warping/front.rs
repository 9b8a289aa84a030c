//! Two neighbouring diagonals, and how they move on.
//!
//! An anti-diagonal k holds the cells (i, k - i). Cells of diagonal `k + 1` need those of `k` and `k - 1` alone, so two
//! diagonals are all that has to be kept to go on from.

use crate::curves::iso18571::warping::band::Warping;
use crate::curves::iso18571::warping::sweep::{Buffers, Tile};

/// Diagonals filled before the next tile is taken, at most.
const MOST_ROWS: usize = 128;

/// Accumulated costs on diagonals `k - 1` and `k`, cells i = `first`.. of both; all others are infinite.
#[derive(Debug, Clone)]
pub(super) struct Front {
    pub(super) k: usize,
    pub(super) first: usize,
    pub(super) before: Vec<f64>,
    pub(super) last: Vec<f64>,
}

impl Front {
    /// The diagonal of (0, 0).
    pub(super) fn corner(warping: &Warping) -> Self {
        let gap = warping.c[0] - warping.t_from(0, 0)[0];
        Self { k: 0, first: 0, before: vec![f64::INFINITY], last: vec![gap * gap] }
    }

    /// Of cell i on diagonal k.
    pub(super) fn cost_at(&self, i: usize) -> f64 {
        i.checked_sub(self.first).and_then(|p| self.last.get(p)).copied().unwrap_or(f64::INFINITY)
    }

    /// One past the last i.
    pub(super) fn end(&self) -> usize {
        self.first + self.last.len()
    }
}

/// The two diagonals in memory for every i that they may reach, and what of them is alive.
struct Moving {
    k: usize,
    /// i of cell 1; cell 0 is that before it.
    base: usize,
    before: Vec<f64>,
    last: Vec<f64>,
    /// First i, and one past the last, that may belong to the least path. Cells elsewhere are infinite.
    alive: (usize, usize),
}

impl Moving {
    /// Room for all i up to `highest_i`; infinite where the front has no cell.
    fn new(front: &Front, highest_i: usize) -> Self {
        let base = front.first;
        let length = (highest_i + 1).saturating_sub(base);
        let room = |cells: &[f64]| {
            let mut all = vec![f64::INFINITY; length + 1];
            let common = cells.len().min(length);
            all[1..=common].copy_from_slice(&cells[..common]);
            all
        };
        let (before, last) = (room(&front.before), room(&front.last));
        Self { k: front.k, base, before, last, alive: (base, front.end().min(base + length)) }
    }

    /// Place of cell i in both lists.
    fn index(&self, i: usize) -> usize {
        i + 1 - self.base
    }

    /// Leaves out, on either end of `from..to`, what costs more than the least path.
    fn prune(&mut self, (from, to): (usize, usize), highest: f64) {
        let cells = self.index(from)..self.index(to);
        let below = |(before, last): (&f64, &f64)| *before <= highest || *last <= highest;
        let mut pairs = self.before[cells.clone()].iter().zip(&self.last[cells]);
        let low = pairs.clone().position(below).map_or(to, |p| from + p);
        let high = pairs.rposition(below).map_or(low, |p| from + p + 1);
        for (first, end) in [(self.alive.0, low), (high, to.max(self.alive.1))] {
            if first < end {
                let cells = self.index(first)..self.index(end);
                self.before[cells.clone()].fill(f64::INFINITY);
                self.last[cells].fill(f64::INFINITY);
            }
        }
        self.alive = (low, high);
    }

    /// A copy of what is alive, to start from again.
    fn front(&self) -> Front {
        let (first, end) = self.alive;
        let cells = self.index(first)..self.index(end);
        Front { k: self.k, first, before: self.before[cells.clone()].to_vec(), last: self.last[cells].to_vec() }
    }
}

impl Warping<'_> {
    /// Moves a front on to diagonal `to`, inside what can reach cell `end`, and shows it every `every` diagonals.
    pub(super) fn fill(
        &self,
        front: &Front,
        to: usize,
        end: (usize, usize),
        every: usize,
        mut show: impl FnMut(Front),
    ) -> Front {
        let most = (self.band / 16).clamp(8, MOST_ROWS);
        let mut moving = Moving::new(front, end.0);
        let mut buffers = Buffers::new();
        let mut ranges = Vec::with_capacity(most);
        let mut next_shown = front.k + every;
        while moving.k < to {
            let k = moving.k;
            let rows = most.min(to - k).min(next_shown - k);
            ranges.clear();
            ranges.extend((k + 1..=k + rows).map(|diagonal| {
                // Steps lead from i to i and i + 1.
                let (from, to) = self.range(diagonal, end);
                let from = from.max(moving.alive.0);
                (from, to.min(moving.alive.1 + diagonal - k).max(from))
            }));
            // After one row the diagonal before is the last one of now, which may begin one cell lower.
            let from = if rows == 1 { moving.alive.0 } else { ranges[0].0 };
            let upto = ranges[rows - 1].1.max(from);
            buffers.start_row(&moving.before, &moving.last, moving.index(from) - 1, rows);
            let mut i = from;
            while i < upto {
                let width = Tile::WIDTH.min(upto - i);
                let cells = moving.index(i)..moving.index(i + width);
                let tile = Tile { k, first: i, ranges: &ranges };
                tile.fill(self, &mut moving.before[cells.clone()], &mut moving.last[cells], &mut buffers);
                i += width;
            }
            moving.k += rows;
            moving.prune((from, upto), self.highest);
            if moving.k == next_shown {
                next_shown += every;
                show(moving.front());
            }
        }
        moving.front()
    }
}

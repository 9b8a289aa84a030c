//! All cells between a front and a cell that can reach it, and the way back through them.
//!
//! From one cell back over L diagonals only cells of a triangle can be on the path: L²/2 costs, kept all at once, so
//! that the path is read off them without computing anything twice.

use pulp::{Simd, WithSimd};

use crate::curves::iso18571::warping::band::Warping;
use crate::curves::iso18571::warping::cells::accumulate;
use crate::curves::iso18571::warping::front::Front;

/// Costs on the front's two diagonals and all after them up to the one before `end`, as far as they can reach that
/// cell.
pub(super) struct Cone {
    /// The front's diagonal.
    k: usize,
    end: (usize, usize),
    /// i of the first column.
    base: usize,
    /// Cells of a row.
    width: usize,
    /// Row by row from diagonal `k - 1` on.
    cells: Vec<f64>,
}

impl Cone {
    /// Fills the triangle from the costs of the front on.
    pub(super) fn new(warping: &Warping, front: &Front, end: (usize, usize)) -> Self {
        let length = end.0 + end.1 - front.k;
        // From diagonal k - 1 up to `length + 1` steps lead upwards in i; one more column stays infinite.
        let base = end.0.saturating_sub(length + 1);
        let width = end.0 + 2 - base;
        let mut cells = vec![f64::INFINITY; width * (length + 1)];
        let (from, to) = (front.first.max(base), front.end().min(end.0 + 1));
        if from < to {
            for (row, known) in [&front.before, &front.last].into_iter().enumerate() {
                let place = row * width + from + 1 - base;
                cells[place..place + to - from].copy_from_slice(&known[from - front.first..to - front.first]);
            }
        }
        let mut cone = Self { k: front.k, end, base, width, cells };
        warping.arch.dispatch(Grow { warping, front, cone: &mut cone });
        cone
    }

    /// Infinite outside the table.
    fn cost(&self, k: usize, i: Option<usize>) -> f64 {
        i.map_or(f64::INFINITY, |i| self.cells[(k + 1 - self.k) * self.width + i + 1 - self.base])
    }

    /// Visits the path's cells before the end back to the front's diagonal; the last of them.
    pub(super) fn path(&self, visit: &mut impl FnMut(usize, usize)) -> (usize, usize) {
        let (mut i, mut j) = self.end;
        while i + j > self.k {
            let k = i + j;
            let lower = i.checked_sub(1);
            let up = self.cost(k - 1, lower);
            let left = self.cost(k - 1, (j > 0).then_some(i));
            let corner = if j > 0 && i > 0 { self.cost(k - 2, lower) } else { f64::INFINITY };
            if j == 0 || (i > 0 && up <= left && up <= corner) {
                i -= 1;
            } else if i == 0 || left <= corner {
                j -= 1;
            } else {
                i -= 1;
                j -= 1;
            }
            visit(i, j);
        }
        (i, j)
    }
}

/// The work of one cone, compiled for each width of vectors.
struct Grow<'a> {
    warping: &'a Warping<'a>,
    front: &'a Front,
    cone: &'a mut Cone,
}

impl WithSimd for Grow<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { warping, front, cone } = self;
        let width = cone.width;
        for k in front.k + 1..cone.end.0 + cone.end.1 {
            let (from, to) = warping.range(k, cone.end);
            let (from, to) = (from.max(front.first), to.min(front.end() + k - front.k));
            if from >= to {
                continue;
            }
            let row = (k + 1 - front.k) * width;
            let (done, next) = cone.cells.split_at_mut(row);
            let (low, high) = (from - cone.base, to - cone.base);
            let (before, last) = (&done[row - 2 * width..row - width], &done[row - width..]);
            let (up, left, corner) = (&last[low..high], &last[low + 1..=high], &before[low..high]);
            accumulate(&warping.c[from..to], warping.t_from(k, from), up, left, corner, &mut next[low + 1..=high]);
        }
    }
}

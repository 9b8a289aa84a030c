//! Dynamic time warping of two curves in a band, without a table of the band.
//!
//! The band is filled along anti-diagonals, whose cells do not depend on each other, several diagonals at a time in
//! tiles that stay in the cache. A narrower band gives a path, and so a cost that the least one does not exceed: on
//! either end of a diagonal, cells above it are left out, for costs only grow along a path (pruned warping; Silva &
//! Batista, SIAM SDM 2016). Sums and minima are monotone in floating point too, so the path is the same to the last
//! tie, for every width of the processor's vectors. A fixed number of fronts is kept; the way back fills again what
//! lies between two of them and can reach the path, in as many levels as it takes until a triangle of cells is small:
//! memory that grows with the band alone.
//!
//! Work: n times the band at worst, for curves that nothing aligns; a fraction of it for curves that resemble each
//! other. No exact method is known whose worst case grows with less than nearly n² (Bringmann & Künnemann, FOCS 2015).

use pulp::{Arch, Simd, WithSimd};

/// Fronts kept of a stretch of diagonals.
const KEPT: usize = 64;

/// Up to this many diagonals every cell that can reach the path is kept: half of 512² numbers, 1 MB.
const TRIANGLE: usize = 512;

/// Two curves and what is left out of their table.
pub struct Warping<'a> {
    c: &'a [f64],
    /// T from its end, so that along a diagonal both curves are read upwards.
    t_reversed: Vec<f64>,
    band: usize,
    /// The least path costs no more.
    highest: f64,
    /// See [`KEPT`].
    kept: usize,
    /// See [`TRIANGLE`].
    triangle: usize,
    /// The widest vectors of this processor.
    arch: Arch,
}

impl<'a> Warping<'a> {
    /// Curves of one length that is not zero; `highest`: a cost that the least path does not exceed.
    fn with_limit(t: &[f64], c: &'a [f64], band: usize, highest: f64) -> Self {
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
    fn end(&self) -> (usize, usize) {
        (self.c.len() - 1, self.c.len() - 1)
    }

    /// i from..to on diagonal k inside band and table, as far as the path can come from there to cell `end`.
    fn range(&self, k: usize, end: (usize, usize)) -> (usize, usize) {
        let (i, j) = end;
        let from = k.saturating_sub(self.band).div_ceil(2).max(k.saturating_sub(j));
        let to = ((k + self.band) / 2).min(k).min(i) + 1;
        (from, to)
    }

    /// T along diagonal k from i on.
    fn t_from(&self, k: usize, i: usize) -> &[f64] {
        &self.t_reversed[self.c.len() - 1 + i - k..]
    }
}

/// Costs of cells of one diagonal from the two before it: `out[p] = (c[p] - t[p])² + min(up, left, corner)[p]`.
///
/// Compiled once for every width of vectors, inside the functions that call it.
#[inline(always)]
fn accumulate(c: &[f64], t: &[f64], up: &[f64], left: &[f64], corner: &[f64], out: &mut [f64]) {
    let length = out.len();
    let (c, t, up, left, corner) = (&c[..length], &t[..length], &up[..length], &left[..length], &corner[..length]);
    for p in 0..length {
        let gap = c[p] - t[p];
        let least = if up[p] < left[p] { up[p] } else { left[p] };
        let least = if least < corner[p] { least } else { corner[p] };
        out[p] = gap * gap + least;
    }
}

// All cells between a front and a cell that can reach it, and the way back through them.
//
// From one cell back over L diagonals only cells of a triangle can be on the path: L²/2 costs, kept all at once, so
// that the path is read off them without computing anything twice.

/// Costs on the front's two diagonals and all after them up to the one before `end`, as far as they can reach that
/// cell.
struct Cone {
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
    fn new(warping: &Warping, front: &Front, end: (usize, usize)) -> Self {
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
    fn path(&self, visit: &mut impl FnMut(usize, usize)) -> (usize, usize) {
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

// Two neighbouring diagonals, and how they move on.
//
// An anti-diagonal k holds the cells (i, k - i). Cells of diagonal `k + 1` need those of `k` and `k - 1` alone, so two
// diagonals are all that has to be kept to go on from.

/// Diagonals filled before the next tile is taken, at most.
const MOST_ROWS: usize = 128;

/// Accumulated costs on diagonals `k - 1` and `k`, cells i = `first`.. of both; all others are infinite.
#[derive(Debug, Clone)]
struct Front {
    k: usize,
    first: usize,
    before: Vec<f64>,
    last: Vec<f64>,
}

impl Front {
    /// The diagonal of (0, 0).
    fn corner(warping: &Warping) -> Self {
        let gap = warping.c[0] - warping.t_from(0, 0)[0];
        Self { k: 0, first: 0, before: vec![f64::INFINITY], last: vec![gap * gap] }
    }

    /// Of cell i on diagonal k.
    fn cost_at(&self, i: usize) -> f64 {
        i.checked_sub(self.first).and_then(|p| self.last.get(p)).copied().unwrap_or(f64::INFINITY)
    }

    /// One past the last i.
    fn end(&self) -> usize {
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
    fn fill(&self, front: &Front, to: usize, end: (usize, usize), every: usize, mut show: impl FnMut(Front)) -> Front {
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

// The path of least cost, from its end to its start.

/// Below this half width a band is filled without a limit from a narrower one.
const NARROWEST: usize = 16;

/// A cost that the least one in the band does not exceed: that of the band's eighth, pruned by that of its eighth in
/// turn.
fn least_cost_is_below(t: &[f64], c: &[f64], band: usize) -> f64 {
    if band < NARROWEST {
        return f64::INFINITY;
    }
    Warping::new(t, c, band / 8).cost()
}

impl<'a> Warping<'a> {
    /// Of curves of one length that is not zero, `|i - j| <= band`.
    pub fn new(t: &[f64], c: &'a [f64], band: usize) -> Self {
        Self::with_limit(t, c, band, least_cost_is_below(t, c, band))
    }

    /// The cost of the least path.
    fn cost(&self) -> f64 {
        let (i, j) = self.end();
        let all = i + j + 1;
        self.fill(&Front::corner(self), i + j, (i, j), all, |_| ()).cost_at(i)
    }

    /// Visits the cells of the path from its end to its start.
    pub fn visit_path(&self, mut visit: impl FnMut(usize, usize)) {
        let (i, j) = self.end();
        visit(i, j);
        self.back(Front::corner(self), (i, j), &mut visit);
    }

    /// Visits the path's cells before `end` back to the front's diagonal; the last of them.
    fn back(&self, front: Front, end: (usize, usize), visit: &mut impl FnMut(usize, usize)) -> (usize, usize) {
        let length = (end.0 + end.1).saturating_sub(front.k);
        if length == 0 {
            return end;
        }
        if length <= self.triangle {
            return Cone::new(self, &front, end).path(visit);
        }
        let mut kept = Vec::with_capacity(self.kept);
        // The diagonal of `end` itself is of no use.
        self.fill(&front, end.0 + end.1 - 1, end, length.div_ceil(self.kept), |between| kept.push(between));
        kept.insert(0, front);
        let mut cell = end;
        while let Some(front) = kept.pop() {
            cell = self.back(front, cell, visit);
        }
        cell
    }
}

// Several diagonals of a stretch of i at once, in memory that stays in the cache.
//
// A tile is some hundred diagonals of a thousand cells: its working memory fits the first cache, and each diagonal is
// one loop without dependencies between its cells. Tiles of a row hand on the costs at their border through
// [`Buffers`].

/// What tiles of one row of tiles hand on, and their working memory.
struct Buffers {
    /// Costs of the cell before the tile on diagonals `k - 1`, `k`, `k + 1`, ...
    column: Vec<f64>,
    /// Three diagonals of a tile, each with the cell before it.
    diagonals: [Vec<f64>; 3],
}

impl Buffers {
    /// Empty; filled by [`start_row`](Self::start_row).
    fn new() -> Self {
        Self { column: Vec::new(), diagonals: std::array::from_fn(|_| vec![0.0; Tile::WIDTH + 1]) }
    }

    /// Before the first tile: the cell at `index` of the two diagonals, and nothing on those to come.
    fn start_row(&mut self, before: &[f64], last: &[f64], index: usize, rows: usize) {
        self.column.clear();
        self.column.extend([before[index], last[index]]);
        self.column.resize(rows + 2, f64::INFINITY);
    }
}

/// Cells `first`.. of the diagonals after k, one for each range of i.
struct Tile<'a> {
    k: usize,
    first: usize,
    /// i from..to that each of the diagonals has.
    ranges: &'a [(usize, usize)],
}

impl Tile<'_> {
    /// Cells side by side: three diagonals and two curves fill a first-level cache of 48 KiB.
    const WIDTH: usize = 1024;

    /// From diagonals `k - 1` and `k` the last two of the tile, in their place.
    fn fill(&self, warping: &Warping, before: &mut [f64], last: &mut [f64], buffers: &mut Buffers) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The same by the whole table, as it is written down.
    fn by_table(t: &[f64], c: &[f64], band: usize) -> Vec<(usize, usize)> {
        let n = t.len();
        let mut d = vec![vec![f64::INFINITY; n]; n];
        let get = |d: &Vec<Vec<f64>>, i: usize, j: usize, di: usize, dj: usize| {
            if i < di || j < dj { f64::INFINITY } else { d[i - di][j - dj] }
        };
        for i in 0..n {
            for j in i.saturating_sub(band)..n.min(i + band + 1) {
                let least = get(&d, i, j, 1, 0).min(get(&d, i, j, 0, 1)).min(get(&d, i, j, 1, 1));
                d[i][j] = (c[i] - t[j]).powi(2) + if i + j == 0 { 0.0 } else { least };
            }
        }
        let (mut i, mut j) = (n - 1, n - 1);
        let mut path = vec![(i, j)];
        while i + j > 0 {
            let steps = [(1, 0), (0, 1), (1, 1)];
            let costs = steps.map(|(di, dj)| get(&d, i, j, di, dj));
            let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
            let (di, dj) = steps[costs.iter().position(|&cost| cost == least).unwrap()];
            (i, j) = (i - di, j - dj);
            path.push((i, j));
        }
        path
    }

    /// 1,500 samples and a band of 1,400 go through tiles side by side, kept fronts and cones between them.
    #[test]
    fn the_path_is_that_of_the_whole_table_ties_included() {
        for n in [1, 2, 3, 10, 57, 200, 431, 1_500] {
            for band in [0, 1, 2, 7, 20, 150, 199, 1_400] {
                let band = band.min(n - 1);
                // Flat stretches on both sides and whole numbers: many ties, and sums without rounding.
                let curve = |shift: usize, height: f64| -> Vec<f64> {
                    (0..n)
                        .map(|k| (k as f64 - shift as f64) / (n as f64 / 3.0))
                        .map(|u| if (0.0..1.0).contains(&u) { (height * (u * 3.1).sin()).round() } else { 0.0 })
                        .collect()
                };
                let (t, c) = (curve(n / 4, 9.0), curve(n / 3, 7.0));
                let plain = by_table(&t, &c, band);
                let least = plain.iter().rev().fold(0.0, |sum, &(i, j)| (c[i] - t[j]).powi(2) + sum);
                // Without a limit, with that of narrower bands, and with the tightest there is.
                for highest in [f64::INFINITY, least_cost_is_below(&t, &c, band), least] {
                    let mut path = Vec::new();
                    Warping::with_limit(&t, &c, band, highest).visit_path(|i, j| path.push((i, j)));
                    assert_eq!(path, plain, "{n} samples, band {band}, costs up to {highest}");
                    // Small parts, as very long curves have large ones: several levels of fronts kept between fronts
                    // kept.
                    let mut deep = Vec::new();
                    let parts = Warping { kept: 3, triangle: 8, ..Warping::with_limit(&t, &c, band, highest) };
                    parts.visit_path(|i, j| deep.push((i, j)));
                    assert_eq!(deep, plain, "{n} samples, band {band}, costs up to {highest}, small parts");
                }
            }
        }
    }

    /// Lengths and bands of every remainder: a front may be kept after one diagonal, or after any number of them.
    #[test]
    fn the_path_is_that_of_the_whole_table_for_curves_with_rounding() {
        for (n, band) in (60..=771).step_by(79).flat_map(|n| [n / 10, n / 10 + 1, n / 7, n / 3].map(|band| (n, band))) {
            let curve = |first: f64, scale: f64| -> Vec<f64> {
                (0..n)
                    .map(|k| ((k as f64 / n as f64 - first) / 0.75).clamp(0.0, 1.0))
                    .map(|u| scale * (25.0 * (PI * u).sin() + 8.0 * (2.0 * PI * u).sin() + 5.0 * (3.0 * PI * u).sin()))
                    .collect()
            };
            let (t, c) = (curve(0.06, 1.0), curve(0.03, 0.8));
            let plain = by_table(&t, &c, band);
            for (kept, triangle) in [(KEPT, TRIANGLE), (KEPT, 8), (3, 8), (16, 64)] {
                for highest in [f64::INFINITY, least_cost_is_below(&t, &c, band)] {
                    let parts = Warping { kept, triangle, ..Warping::with_limit(&t, &c, band, highest) };
                    let mut path = Vec::new();
                    parts.visit_path(|i, j| path.push((i, j)));
                    assert_eq!(path, plain, "{n} samples, band {band}, costs up to {highest}, {kept} fronts kept");
                }
            }
        }
    }
}

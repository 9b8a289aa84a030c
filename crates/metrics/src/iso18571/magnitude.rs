//! Dynamic time warping in a band, without a table of the band.

/// `Σ|C - T|/Σ|T|` along the warping path; `None` where T is zero along it.
///
/// Least sum of `(C_i - T_j)²` with steps (i-1, j), (i, j-1), (i-1, j-1) from both starts to both ends, in the band
/// `|i - j| <= ceil(window·n) - 1`; the way back goes to the smallest accumulated neighbour, among equals in that order.
///
/// Filled along anti-diagonals, whose cells do not depend on each other. A narrower band gives a path, and so a cost that the
/// least one does not exceed: on either end of a diagonal, cells above it are left out, for costs only grow along a path
/// (pruned warping; Silva & Batista, SIAM SDM 2016). Sums and minima are monotone in floating point too, so the path is the
/// same to the last tie. Two neighbouring diagonals are kept every sqrt(2n) of them, and the way back fills again what lies
/// between two kept pairs and can reach the path: memory of band times sqrt(n) instead of band times n.
///
/// Work: n times the band at worst, for curves that nothing aligns; a fraction of it for curves that resemble each other. No
/// exact method is known whose worst case grows with less than nearly n² (Bringmann & Künnemann, FOCS 2015).
pub(super) fn error(t: &[f64], c: &[f64], window: f64) -> Option<f64> {
    let n = t.len();
    if n == 0 {
        return None;
    }
    let band = ((window * n as f64).ceil() - 1.0).clamp(0.0, (n - 1) as f64) as usize;
    let table = Table::new(t, c, band, least_cost_is_below(t, c, band));
    let (mut gap, mut size) = (0.0, 0.0);
    table.walk_back(|i, j| {
        gap += (c[i] - t[j]).abs();
        size += t[j].abs();
    });
    let error = gap / size;
    error.is_finite().then_some(error)
}

/// A cost that the least one in the band does not exceed: that of the band's eighth, pruned by that of its eighth in turn.
fn least_cost_is_below(t: &[f64], c: &[f64], band: usize) -> f64 {
    if band < NARROWEST {
        return f64::INFINITY;
    }
    let narrow = band / 8;
    Table::empty(t, c, narrow, least_cost_is_below(t, c, narrow)).fill_all(|_, _, _| ())
}

/// Below this half width a band is filled at once.
const NARROWEST: usize = 16;

/// Accumulated costs on the diagonal `i + j = k` for a range of i, with an infinite cell at either end.
#[derive(Debug, Clone)]
struct Diagonal {
    /// i of the first cell.
    first: usize,
    /// Cell of i is `cells[i - first + 1]`.
    cells: Vec<f64>,
    /// From the first to one past the last i whose cost may belong to the least path; crossed where there is none.
    alive: (usize, usize),
}

impl Diagonal {
    fn empty() -> Self {
        Self { first: 0, cells: vec![f64::INFINITY; 2], alive: (0, 0) }
    }

    /// One past the last i.
    fn end(&self) -> usize {
        self.first + self.cells.len() - 2
    }

    fn get(&self, i: usize) -> f64 {
        (i + 1).checked_sub(self.first).and_then(|k| self.cells.get(k)).copied().unwrap_or(f64::INFINITY)
    }
}

/// Two neighbouring diagonals `k - 1` and `k`.
struct Kept {
    k: usize,
    before: Diagonal,
    last: Diagonal,
}

struct Table<'a> {
    c: &'a [f64],
    /// T from its end, so that along a diagonal both curves are read upwards.
    t_reversed: Vec<f64>,
    band: usize,
    /// The least path costs no more.
    highest: f64,
    kept: Vec<Kept>,
}

impl<'a> Table<'a> {
    fn empty(t: &[f64], c: &'a [f64], band: usize, highest: f64) -> Self {
        Self { c, t_reversed: t.iter().rev().copied().collect(), band, highest, kept: Vec::new() }
    }

    fn new(t: &[f64], c: &'a [f64], band: usize, highest: f64) -> Self {
        let mut table = Self::empty(t, c, band, highest);
        let every = ((2.0 * c.len() as f64).sqrt().ceil() as usize).max(1);
        let mut kept = Vec::new();
        table.fill_all(|k, before, last| {
            if k % every == 0 {
                kept.push(Kept { k, before: before.clone(), last: last.clone() });
            }
        });
        table.kept = kept;
        table
    }

    /// Fills every diagonal and shows it with the one before it; the cost of the least path.
    fn fill_all(&self, mut show: impl FnMut(usize, &Diagonal, &Diagonal)) -> f64 {
        let (mut before, mut last, mut next) = (Diagonal::empty(), self.corner(), Diagonal::empty());
        show(0, &before, &last);
        for k in 1..2 * self.c.len() - 1 {
            let (from, to) = self.range(k, &before, &last);
            self.fill(k, from, to, &before, &last, &mut next);
            std::mem::swap(&mut before, &mut last);
            std::mem::swap(&mut last, &mut next);
            show(k, &before, &last);
        }
        last.get(self.c.len() - 1)
    }

    /// The diagonal of (0, 0).
    fn corner(&self) -> Diagonal {
        let gap = self.c[0] - self.t_reversed[self.c.len() - 1];
        Diagonal { first: 0, cells: vec![f64::INFINITY, gap * gap, f64::INFINITY], alive: (0, 1) }
    }

    /// i from..to on diagonal k inside the band and the table that can be reached from what is alive on the two before it.
    fn range(&self, k: usize, before: &Diagonal, last: &Diagonal) -> (usize, usize) {
        let n = self.c.len();
        let from = k.saturating_sub(self.band).div_ceil(2).max((k + 1).saturating_sub(n));
        let to = ((k + self.band) / 2).min(k).min(n - 1) + 1;
        // Steps lead from i on the last to i and i + 1, from i on the one before to i + 1.
        let reached_from = last.alive.0.min(before.alive.0 + 1).max(last.first);
        let reached_to = (last.alive.1.max(before.alive.1) + 1).min(last.end() + 1);
        let from = from.max(reached_from);
        (from, to.min(reached_to).max(from))
    }

    /// Fills cells `from..to` of diagonal k from the two before it.
    fn fill(&self, k: usize, from: usize, to: usize, before: &Diagonal, last: &Diagonal, next: &mut Diagonal) {
        let (n, length) = (self.c.len(), to - from);
        next.first = from;
        next.cells.resize(length + 2, f64::INFINITY);
        next.cells[0] = f64::INFINITY;
        next.cells[length + 1] = f64::INFINITY;
        // Crossed: nothing alive.
        next.alive = (to, from);
        if length == 0 {
            return;
        }
        let c = &self.c[from..to];
        // T[k - i] for i = from..to.
        let t = &self.t_reversed[n - 1 + from - k..][..length];
        // (i-1, j), (i, j-1) on the last diagonal, (i-1, j-1) on the one before.
        let up = &last.cells[from - last.first..][..length];
        let left = &last.cells[from - last.first + 1..][..length];
        let corner = &before.cells[from - before.first..][..length];
        let out = &mut next.cells[1..=length];
        for p in 0..length {
            let gap = c[p] - t[p];
            let one = if up[p] < left[p] { up[p] } else { left[p] };
            let least = if one < corner[p] { one } else { corner[p] };
            out[p] = gap * gap + least;
        }
        let below = |cost: &f64| *cost <= self.highest;
        if let (Some(low), Some(high)) = (out.iter().position(below), out.iter().rposition(below)) {
            next.alive = (from + low, from + high + 1);
        }
    }

    /// Visits the path from its end to its start.
    fn walk_back(&self, mut visit: impl FnMut(usize, usize)) {
        let n = self.c.len();
        let (mut i, mut j) = (n - 1, n - 1);
        visit(i, j);
        for kept in self.kept.iter().rev() {
            let end = i + j;
            if end <= kept.k {
                continue;
            }
            // Diagonals kept.k - 1 ..= end - 1, as far as the path can come from there.
            let mut rows = Vec::with_capacity(end - kept.k + 1);
            rows.push(kept.before.clone());
            rows.push(kept.last.clone());
            for k in kept.k + 1..end {
                let (before, last) = (&rows[rows.len() - 2], &rows[rows.len() - 1]);
                let (from, to) = self.range(k, before, last);
                let (from, to) = (from.max((i + k).saturating_sub(end)), to.min(i + 1));
                let mut next = Diagonal::empty();
                self.fill(k, from, to.max(from), before, last, &mut next);
                rows.push(next);
            }
            let row = |k: usize| &rows[k + 1 - kept.k];
            while i + j > kept.k {
                let k = i + j;
                let up = if i > 0 { row(k - 1).get(i - 1) } else { f64::INFINITY };
                let left = if j > 0 { row(k - 1).get(i) } else { f64::INFINITY };
                let corner = if i > 0 && j > 0 { row(k - 2).get(i - 1) } else { f64::INFINITY };
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
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn the_path_is_that_of_the_whole_table_ties_included() {
        for n in [1, 2, 3, 10, 57, 200, 431] {
            for band in [0, 1, 2, 7, 20, 150, 199] {
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
                    Table::new(&t, &c, band, highest).walk_back(|i, j| path.push((i, j)));
                    assert_eq!(path, plain, "{n} samples, band {band}, costs up to {highest}");
                }
            }
        }
    }
}

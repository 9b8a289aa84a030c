//! Dynamic time warping in a band, without a table of the band.

/// `Σ|C - T|/Σ|T|` along the warping path; `None` where T is zero along it.
///
/// Least sum of `(C_i - T_j)²` with steps (i-1, j), (i, j-1), (i-1, j-1) from both starts to both ends, in the band
/// `|i - j| <= ceil(window·n) - 1`; the way back goes to the smallest accumulated neighbour, among equals in that order.
///
/// Filled along anti-diagonals, whose cells do not depend on each other. Two neighbouring diagonals are kept every
/// sqrt(2n) of them, and the way back fills again what lies between two kept pairs and can reach the path: memory of
/// band times sqrt(n) instead of band times n, at 1.1 of the time.
pub(super) fn error(t: &[f64], c: &[f64], window: f64) -> Option<f64> {
    let n = t.len();
    if n == 0 {
        return None;
    }
    let band = ((window * n as f64).ceil() - 1.0).clamp(0.0, (n - 1) as f64) as usize;
    let table = Table::new(t, c, band);
    let (mut gap, mut size) = (0.0, 0.0);
    table.walk_back(|i, j| {
        gap += (c[i] - t[j]).abs();
        size += t[j].abs();
    });
    let error = gap / size;
    error.is_finite().then_some(error)
}

/// Accumulated costs on the diagonal `i + j = k` for a range of i, with an infinite cell at either end.
#[derive(Debug, Clone)]
struct Diagonal {
    /// i of the first cell.
    first: usize,
    /// Cell of i is `cells[i - first + 1]`.
    cells: Vec<f64>,
}

impl Diagonal {
    fn empty() -> Self {
        Self { first: 0, cells: vec![f64::INFINITY; 2] }
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
    kept: Vec<Kept>,
}

impl<'a> Table<'a> {
    fn new(t: &[f64], c: &'a [f64], band: usize) -> Self {
        let n = t.len();
        let mut table = Self { c, t_reversed: t.iter().rev().copied().collect(), band, kept: Vec::new() };
        let every = ((2.0 * n as f64).sqrt().ceil() as usize).max(1);
        let (mut before, mut last, mut next) = (Diagonal::empty(), table.corner(), Diagonal::empty());
        for k in 0..2 * n - 1 {
            if k > 0 {
                let (from, to) = table.range(k);
                table.fill(k, from, to, &before, &last, &mut next);
                std::mem::swap(&mut before, &mut last);
                std::mem::swap(&mut last, &mut next);
            }
            if k % every == 0 {
                table.kept.push(Kept { k, before: before.clone(), last: last.clone() });
            }
        }
        table
    }

    /// The diagonal of (0, 0).
    fn corner(&self) -> Diagonal {
        let gap = self.c[0] - self.t_reversed[self.c.len() - 1];
        Diagonal { first: 0, cells: vec![f64::INFINITY, gap * gap, f64::INFINITY] }
    }

    /// i from..to on diagonal k inside the band and the table.
    fn range(&self, k: usize) -> (usize, usize) {
        let n = self.c.len();
        let from = k.saturating_sub(self.band).div_ceil(2).max((k + 1).saturating_sub(n));
        let to = ((k + self.band) / 2).min(k).min(n - 1) + 1;
        (from, to.max(from))
    }

    /// Fills cells `from..to` of diagonal k from the two before it.
    fn fill(&self, k: usize, from: usize, to: usize, before: &Diagonal, last: &Diagonal, next: &mut Diagonal) {
        let (n, length) = (self.c.len(), to - from);
        next.first = from;
        next.cells.resize(length + 2, f64::INFINITY);
        next.cells[0] = f64::INFINITY;
        next.cells[length + 1] = f64::INFINITY;
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
                let (from, to) = self.range(k);
                let (from, to) = (from.max((i + k).saturating_sub(end)), to.min(i + 1));
                let mut next = Diagonal::empty();
                self.fill(k, from, to.max(from), &rows[rows.len() - 2], &rows[rows.len() - 1], &mut next);
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
        for n in [1, 2, 3, 10, 57, 200] {
            for band in [0, 1, 2, 7, 20, 199] {
                let band = band.min(n - 1);
                // Flat stretches on both sides: many ties.
                let curve = |shift: usize, height: f64| -> Vec<f64> {
                    (0..n)
                        .map(|k| (k as f64 - shift as f64) / (n as f64 / 3.0))
                        .map(|u| if (0.0..1.0).contains(&u) { (height * (u * 3.1).sin()).round() } else { 0.0 })
                        .collect()
                };
                let (t, c) = (curve(n / 4, 9.0), curve(n / 3, 7.0));
                let mut path = Vec::new();
                Table::new(&t, &c, band).walk_back(|i, j| path.push((i, j)));
                assert_eq!(path, by_table(&t, &c, band), "{n} samples, band {band}");
            }
        }
    }
}

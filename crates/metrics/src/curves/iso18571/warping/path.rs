//! The path of least cost, from its end to its start.

use crate::curves::iso18571::warping::band::Warping;
use crate::curves::iso18571::warping::cone::Cone;
use crate::curves::iso18571::warping::front::Front;

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

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::curves::iso18571::warping::band::{KEPT, TRIANGLE};

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

//! Linear least squares: tall systems row block by row block, and with non-negative unknowns.

use nalgebra::{DMatrix, DVector};
use pulp::{Arch, Simd, WithSimd};

use crate::linalg;
use crate::linalg::{dot, dot_here};

/// A gradient counts as zero below this share of the column's length times that of the right side: rounding of an
/// inner product of some thousand terms.
const FLAT: f64 = 1e-13;

/// `x >= 0` that minimises `|A x - b|`, and which `x` are free (the others are zero).
///
/// The active-set method of Lawson and Hanson, *Solving Least Squares Problems*, 1974, chapter 23, on the triangular
/// factor of `A`. At the end the gradient is zero on what is free and not negative on what is held at zero, to
/// rounding. Columns that depend on earlier free ones stay at zero. `A` has any number of rows, columns of any length;
/// both must be finite. Ends after `4 n` exchanges at most with the best point so far.
pub fn nonnegative_least_squares(a: &DMatrix<f64>, b: &DVector<f64>) -> (DVector<f64>, Vec<bool>) {
    let n = a.ncols();
    let lengths: Vec<f64> = a.column_iter().map(|c| if c.norm() > 0.0 { c.norm() } else { 1.0 }).collect();
    let size = b.norm();
    let mut scaled = a.clone();
    for (mut column, length) in scaled.column_iter_mut().zip(&lengths) {
        column /= *length;
    }
    // Few rows, or none of their own: a factor of at most n rows has the same inner products.
    let (a, b) = if scaled.nrows() > n {
        let qr = scaled.qr();
        let mut right = DMatrix::from_column_slice(b.len(), 1, b.as_slice());
        qr.q_tr_mul(&mut right);
        (qr.r(), DVector::from_column_slice(&right.as_slice()[..n]))
    } else {
        (scaled, b.clone())
    };
    let mut x = DVector::zeros(n);
    let mut free = vec![false; n];
    let mut dependent = vec![false; n];
    for _ in 0..4 * n {
        let slope = a.tr_mul(&(&b - &a * &x));
        let entering = (0..n)
            .filter(|&i| !free[i] && !dependent[i] && slope[i] > FLAT * size)
            .max_by(|&i, &j| slope[i].total_cmp(&slope[j]));
        let Some(entering) = entering else { break };
        free[entering] = true;
        let mut solved = solve(&a, &b, &free);
        if solved.is_none() {
            (free[entering], dependent[entering]) = (false, true);
            continue;
        }
        while let Some(solution) = solved {
            // As far as the first that would turn negative.
            let blocking = (0..n)
                .filter(|&i| free[i] && solution[i] <= 0.0)
                .map(|i| (if x[i] > 0.0 { x[i] / (x[i] - solution[i]) } else { 0.0 }, i))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((share, place)) = blocking else {
                x = solution;
                break;
            };
            x += (solution - &x) * share;
            x[place] = 0.0;
            free[place] = false;
            solved = solve(&a, &b, &free);
        }
    }
    (DVector::from_fn(n, |i, _| x[i] / lengths[i]), free)
}

/// The least squares solution with the columns that are free, zero elsewhere; `None` where they depend on each other.
fn solve(a: &DMatrix<f64>, b: &DVector<f64>, free: &[bool]) -> Option<DVector<f64>> {
    let set: Vec<usize> = (0..free.len()).filter(|&i| free[i]).collect();
    let mut x = DVector::zeros(free.len());
    if set.is_empty() {
        return Some(x);
    }
    if set.len() > a.nrows() {
        return None;
    }
    let qr = a.select_columns(&set).qr();
    let r = qr.r();
    if (0..set.len()).any(|i| r[(i, i)].abs() < FLAT) {
        return None;
    }
    let mut right = DMatrix::from_column_slice(b.len(), 1, b.as_slice());
    qr.q_tr_mul(&mut right);
    let solution = r.solve_upper_triangular(&right.rows(0, set.len()))?;
    for (i, &k) in set.iter().enumerate() {
        x[k] = solution[i];
    }
    Some(x)
}

// Tall least-squares problems by orthogonal transformations, without holding the whole matrix.
//
// `min |A x - b|` with `A` of `rows x columns`: push `[A, b]` in blocks of rows, then [`TriangularFactor::solve`]. The
// error of the solution is that of one Householder QR: rounding times the condition number of the column-scaled `A`,
// which is returned.

/// Condition number of the column-scaled equations above which a solution is refused.
pub const CONDITION_LIMIT: f64 = 1e12;

/// The triangular factor of a tall matrix that arrives in blocks of rows.
///
/// Householder reflections of `[R; block]`, two at a time: the same backward error as one QR of the whole, and no
/// normal equations. Cost `2 rows columns²`; memory one block.
#[derive(Debug, Clone)]
pub struct TriangularFactor {
    columns: usize,
    rows: usize,
    /// Upper triangle, column after column.
    r: Vec<f64>,
}

impl TriangularFactor {
    /// The factor of a matrix with `columns` columns and no rows yet.
    pub fn new(columns: usize) -> Self {
        Self { columns, rows: 0, r: vec![0.0; columns * columns] }
    }

    /// Number of rows per block that stays in the fastest cache.
    pub fn block_rows(columns: usize) -> usize {
        (4096 / columns.max(1)).clamp(96, 1024)
    }

    /// Adds the rows of a block: `rows` entries of the first column, then of the second, ... The block is destroyed.
    pub fn push(&mut self, rows: usize, block: &mut [f64]) {
        Arch::new().dispatch(Push { factor: self, rows, block });
    }

    /// The same in the vectors of the caller; all of it is inlined there.
    #[inline(always)]
    fn push_here(&mut self, rows: usize, block: &mut [f64]) {
        let p = self.columns;
        debug_assert_eq!(block.len(), rows * p);
        self.rows += rows;
        for j in (0..p).step_by(2) {
            let (done, rest) = block.split_at_mut((j + 1) * rows);
            let x = &done[j * rows..];
            let first = self.reflection(j, x);
            if rest.is_empty() {
                break;
            }
            let (y, rest) = rest.split_at_mut(rows);
            let top = &mut self.r[(j + 1) * p + j];
            let s = first.share(top, dot_here(x, y));
            for (y, x) in y.iter_mut().zip(x) {
                *y -= s * x;
            }
            let y = &*y;
            let second = self.reflection(j + 1, y);
            let cross = dot_here(x, y);
            // Both on two columns in one pass: half the traffic between cache and registers.
            let mut tops = self.r[(j + 2) * p..].chunks_exact_mut(p);
            let mut pairs = rest.chunks_exact_mut(2 * rows);
            for pair in &mut pairs {
                let (c, d) = pair.split_at_mut(rows);
                let [xc, yc, xd, yd] = four_products(x, y, c, d);
                let mut both = |of_x: f64, of_y: f64| {
                    let Some([one, two]) = tops.next().map(|top| &mut top[j..j + 2]) else { return [0.0; 2] };
                    let s = first.share(one, of_x);
                    [s, second.share(two, of_y - s * cross)]
                };
                let ([sc, tc], [sd, td]) = (both(xc, yc), both(xd, yd));
                for (((c, d), x), y) in c.iter_mut().zip(d.iter_mut()).zip(x).zip(y) {
                    *c -= sc * x + tc * y;
                    *d -= sd * x + td * y;
                }
            }
            let last = pairs.into_remainder();
            if let (Some(top), false) = (tops.next(), last.is_empty()) {
                let s = first.share(&mut top[j], dot_here(x, last));
                let t = second.share(&mut top[j + 1], dot_here(y, last) - s * cross);
                for ((c, x), y) in last.iter_mut().zip(x).zip(y) {
                    *c -= s * x + t * y;
                }
            }
        }
    }

    /// The reflection that takes `x`, below the diagonal entry `j`, to zero; that entry becomes what it has to be.
    #[inline(always)]
    fn reflection(&mut self, j: usize, x: &[f64]) -> Reflection {
        let sigma = dot_here(x, x);
        if sigma == 0.0 {
            return Reflection { head: 0.0, factor: 0.0 };
        }
        let diagonal = &mut self.r[j * self.columns + j];
        let norm = diagonal.hypot(sigma.sqrt());
        let beta = if *diagonal > 0.0 { -norm } else { norm };
        let head = *diagonal - beta;
        *diagonal = beta;
        Reflection { head, factor: 2.0 / (head * head + sigma) }
    }

    /// Adds the rows that another factor stands for.
    pub fn merge(&mut self, other: &Self) {
        debug_assert_eq!(self.columns, other.columns);
        let rows = self.rows + other.rows;
        let mut block = other.r.clone();
        self.push(self.columns, &mut block);
        self.rows = rows;
    }

    /// Number of rows taken so far.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Column `j` of the factor down to its diagonal entry: `j + 1` entries.
    pub fn column(&self, j: usize) -> &[f64] {
        &self.r[j * self.columns..=j * (self.columns + 1)]
    }

    /// Solves for the last column in terms of the others by back substitution, without a look at the condition; `None`
    /// where a coefficient is not finite.
    pub fn back_substitution(&self) -> Option<Vec<f64>> {
        let p = self.columns.checked_sub(1)?;
        let mut x = self.column(p)[..p].to_vec();
        for j in (0..p).rev() {
            let (above, diagonal) = self.column(j).split_at(j);
            let value = x[j] / diagonal[0];
            if !value.is_finite() {
                return None;
            }
            x[j] = value;
            x[..j].iter_mut().zip(above).for_each(|(x, r)| *x -= value * r);
        }
        Some(x)
    }

    /// The factor as a matrix.
    pub fn matrix(&self) -> DMatrix<f64> {
        DMatrix::from_column_slice(self.columns, self.columns, &self.r)
    }

    /// Solves for the last `targets` columns in terms of the others.
    ///
    /// Columns are scaled to norm 1, then a singular value decomposition of the triangle tells the condition number.
    /// Singular values below `truncation` of the largest count as zero (the solution of least norm in scaled columns).
    /// `None` if the decomposition does not settle or a column is not finite.
    pub fn solve(&self, targets: usize, truncation: f64) -> Option<Solution> {
        let p = self.columns - targets;
        let r = self.matrix();
        if r.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let norms: Vec<f64> =
            (0..p).map(|j| r.column(j).norm()).map(|norm| if norm > 0.0 { norm } else { 1.0 }).collect();
        let scaled = DMatrix::from_fn(p, p, |i, j| r[(i, j)] / norms[j]);
        let svd = linalg::jacobi_svd(&scaled)?;
        let largest = svd.values.first().copied().unwrap_or(0.0);
        let rank = svd.values.iter().take_while(|s| **s > truncation * largest && **s > 0.0).count();
        let smallest = svd.values.last().copied().unwrap_or(0.0);
        let mut coefficients = DMatrix::zeros(p, targets);
        let mut residual_squares = Vec::with_capacity(targets);
        for t in 0..targets {
            let rhs: Vec<f64> = r.column(p + t).iter().copied().collect();
            let mut missed = dot(&rhs[p..], &rhs[p..]);
            for i in 0..p {
                let part = dot(svd.left.column(i).as_slice(), &rhs[..p]);
                if i < rank {
                    for j in 0..p {
                        coefficients[(j, t)] += svd.right[(j, i)] * part / svd.values[i] / norms[j];
                    }
                } else {
                    missed += part * part;
                }
            }
            residual_squares.push(missed);
        }
        let inverse_square = DMatrix::from_fn(p, p, |i, j| {
            (0..rank).map(|k| svd.right[(i, k)] * svd.right[(j, k)] / (svd.values[k] * svd.values[k])).sum::<f64>()
                / (norms[i] * norms[j])
        });
        Some(Solution {
            coefficients,
            residual_squares,
            rank,
            condition: if smallest > 0.0 { largest / smallest } else { f64::INFINITY },
            inverse_square,
        })
    }
}

/// `1 - factor v v'`, `v` of a head on a row of the triangle and a tail in the block.
#[derive(Clone, Copy)]
struct Reflection {
    head: f64,
    factor: f64,
}

impl Reflection {
    /// How often the tail is to be taken from a column whose product with it is given; the entry on the triangle's row
    /// is dealt with here.
    #[inline]
    fn share(self, top: &mut f64, product: f64) -> f64 {
        let share = self.factor * (*top * self.head + product);
        *top -= share * self.head;
        share
    }
}

/// A block of rows on its way into a factor.
struct Push<'a> {
    factor: &'a mut TriangularFactor,
    rows: usize,
    block: &'a mut [f64],
}

impl WithSimd for Push<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.factor.push_here(self.rows, self.block);
    }
}

/// `x·c`, `y·c`, `x·d`, `y·d` in one pass.
#[inline(always)]
fn four_products(x: &[f64], y: &[f64], c: &[f64], d: &[f64]) -> [f64; 4] {
    const LANES: usize = 4;
    let ((xs, x), (ys, y)) = (x.as_chunks::<LANES>(), y.as_chunks::<LANES>());
    let ((cs, c), (ds, d)) = (c.as_chunks::<LANES>(), d.as_chunks::<LANES>());
    let mut sums = [[0.0; LANES]; 4];
    for (((x, y), c), d) in xs.iter().zip(ys).zip(cs).zip(ds) {
        for lane in 0..LANES {
            sums[0][lane] += x[lane] * c[lane];
            sums[1][lane] += y[lane] * c[lane];
            sums[2][lane] += x[lane] * d[lane];
            sums[3][lane] += y[lane] * d[lane];
        }
    }
    let rest = [dot_here(x, c), dot_here(y, c), dot_here(x, d), dot_here(y, d)];
    std::array::from_fn(|k| sums[k].iter().sum::<f64>() + rest[k])
}

/// The solution of a least-squares problem, by [`TriangularFactor::solve`].
#[derive(Debug, Clone)]
pub struct Solution {
    /// One column per target.
    pub coefficients: DMatrix<f64>,
    /// Sum of squared residuals of every target.
    pub residual_squares: Vec<f64>,
    /// Number of singular values that count.
    pub rank: usize,
    /// Condition number of the column-scaled equations, before truncation.
    pub condition: f64,
    /// `(X' X)⁻¹`, to be multiplied by the noise variance.
    pub inverse_square: DMatrix<f64>,
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    #[test]
    fn keeps_the_unconstrained_solution_where_it_is_positive_and_the_border_elsewhere() {
        // The factor of [1 0.5; 0.5 1].
        let a = DMatrix::from_row_slice(2, 2, &[1.0, 0.5, 0.0, 0.75_f64.sqrt()]);
        let of = |b: [f64; 2]| {
            let right = a.transpose().lu().solve(&DVector::from_column_slice(&b)).unwrap();
            nonnegative_least_squares(&a, &right)
        };
        // 2/3 each.
        let (inside, _) = of([1.0, 1.0]);
        assert!((inside[0] - 2.0 / 3.0).abs() < 1e-12 && (inside[1] - 2.0 / 3.0).abs() < 1e-12);
        let (border, free) = of([1.0, 0.1]);
        assert!((border[0] - 1.0).abs() < 1e-12 && border[1] == 0.0);
        assert_eq!(free, [true, false]);
    }

    /// The conditions of the optimum on random problems: gradient zero where free, not negative where held.
    #[test]
    fn meets_the_conditions_of_the_optimum() {
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let mut held = 0;
        for _ in 0..100 {
            let scales: Vec<f64> = (0..9).map(|_| 10.0_f64.powf(3.0 * next())).collect();
            let a = DMatrix::from_fn(30, 9, |_, j| next() * scales[j]);
            let b = DVector::from_fn(30, |_, _| next());
            let (x, free) = nonnegative_least_squares(&a, &b);
            let gradient = a.tr_mul(&(&a * &x - &b));
            for i in 0..9 {
                let size = a.column(i).norm() * b.norm();
                if free[i] {
                    assert!(x[i] > 0.0 && gradient[i].abs() < 1e-12 * size, "{i} {:e}", gradient[i] / size);
                } else {
                    assert!(x[i] == 0.0 && gradient[i] > -1e-12 * size, "{i} {:e}", gradient[i] / size);
                    held += 1;
                }
            }
        }
        assert!(held > 100);
    }

    fn entry(i: usize, j: usize) -> f64 {
        ((i * 7 + j * 13) as f64 * 0.37).sin() + if i == j { 2.0 } else { 0.0 }
    }

    #[test]
    fn blocks_give_the_solution_of_the_whole() {
        let exact = [1.5, -2.0, 0.25];
        let mut factor = TriangularFactor::new(4);
        for block in 0..7 {
            let rows = 11;
            let mut data = vec![0.0; 4 * rows];
            for i in 0..rows {
                let x: Vec<f64> = (0..3).map(|j| entry(block * rows + i, j)).collect();
                for j in 0..3 {
                    data[j * rows + i] = x[j];
                }
                data[3 * rows + i] = dot(&x, &exact);
            }
            factor.push(rows, &mut data);
        }
        let solution = factor.solve(1, 0.0).unwrap();
        assert_eq!(factor.rows(), 77);
        for (found, exact) in solution.coefficients.iter().zip(exact) {
            // Rounding of a well-conditioned problem.
            assert!((found - exact).abs() < 1e-13, "{found} {exact}");
        }
        assert!(solution.residual_squares[0] < 1e-25 && solution.condition < 10.0);
        for (substituted, decomposed) in factor.back_substitution().unwrap().iter().zip(solution.coefficients.iter()) {
            assert!((substituted - decomposed).abs() < 1e-13, "{substituted} {decomposed}");
        }
    }

    #[test]
    fn merged_factors_stand_for_all_rows() {
        let rows = 20;
        let data: Vec<f64> = (0..3).flat_map(|j| (0..rows).map(move |i| entry(i, j))).collect();
        let mut whole = TriangularFactor::new(3);
        whole.push(rows, &mut data.clone());
        let half = |first: usize| {
            let mut part: Vec<f64> = (0..3).flat_map(|j| (first..first + 10).map(move |i| entry(i, j))).collect();
            let mut factor = TriangularFactor::new(3);
            factor.push(10, &mut part);
            factor
        };
        let mut merged = half(0);
        merged.merge(&half(10));
        let (a, b) = (whole.matrix(), merged.matrix());
        // R is unique up to signs of its rows.
        assert!((a.map(f64::abs) - b.map(f64::abs)).amax() < 1e-13);
        assert_eq!(merged.rows(), 20);
    }

    #[test]
    fn equal_columns_are_truncated_and_reported() {
        let rows = 30;
        let mut data: Vec<f64> = [0, 0, 1].iter().flat_map(|&j| (0..rows).map(move |i| entry(i, j))).collect();
        let mut factor = TriangularFactor::new(3);
        factor.push(rows, &mut data);
        let solution = factor.solve(1, 1e-12).unwrap();
        assert!(solution.condition > 1e14);
        // The least-norm solution shares the weight equally.
        assert!((solution.coefficients[0] - solution.coefficients[1]).abs() < 1e-14);
    }
}

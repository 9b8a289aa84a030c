//! Non-negative least squares by an active set on the triangular factor; the normal equations are not formed.

use nalgebra::{DMatrix, DVector};

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
        if solve(&a, &b, &free).is_none() {
            (free[entering], dependent[entering]) = (false, true);
            continue;
        }
        while let Some(solution) = solve(&a, &b, &free) {
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

#[cfg(test)]
mod tests {
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
}

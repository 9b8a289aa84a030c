//! Inner products of stretches of signals that are shifted copies of one another.

use std::collections::BTreeMap;

use crumple_numerics::linalg::dot;
use nalgebra::DMatrix;

/// A pivot of the Cholesky factor (column norms 1) below which QR is left to it: columns within 1e-2 of dependent.
/// Above, the factor agrees with that of QR to about 1e-12.
const SAFE_PIVOT: f64 = 1e-4;

/// Square of the ratio of norms of two stretches of one signal below which sliding sums would lose digits of the
/// smaller.
const LEAST_RATIO: f64 = 0.01;

/// Inner products of all columns `signals[s][offset..offset + rows]`, `(s, offset)` of each given.
///
/// For one pair of signals and one distance of their offsets they are sums over a window that slides: the first is
/// summed, the others follow by what enters and leaves.
///
/// The result is symmetric, one row and column per given column. A sliding sum loses digits of what is small against
/// what has passed through it: errors are those of the largest stretch, which [`triangular_factor_by_products`]
/// guards against.
pub(crate) fn shifted_products(signals: &[&[f64]], columns: &[(usize, usize)], rows: usize) -> DMatrix<f64> {
    let mut order: Vec<usize> = (0..columns.len()).collect();
    // Along a diagonal: the same two signals, the same distance, rising offsets.
    order.sort_by_key(|j| columns[*j]);
    let mut products = DMatrix::zeros(order.len(), order.len());
    let mut last: BTreeMap<(usize, usize, usize), (usize, f64)> = BTreeMap::new();
    for (position, &i) in order.iter().enumerate() {
        let (s, from_i) = columns[i];
        for &j in &order[position..] {
            let (t, from_j) = columns[j];
            let key = (s, t, from_j.wrapping_sub(from_i));
            let (a, b) = (signals[s], signals[t]);
            let product = match last.get(&key) {
                Some(&(from, sum)) if from + 1 == from_i => {
                    sum - a[from_i - 1] * b[from_j - 1] + a[from_i - 1 + rows] * b[from_j - 1 + rows]
                }
                _ => dot(&a[from_i..from_i + rows], &b[from_j..from_j + rows]),
            };
            last.insert(key, (from_i, product));
            products[(i, j)] = product;
            products[(j, i)] = product;
        }
    }
    products
}

/// The triangular factor of the same columns, from their inner products; `None` where sums of products would lose
/// digits: columns near dependent, a silent one, or a signal that fades or grows. QR is then the way.
///
/// Cholesky: `R` with `R'R` the matrix of products, upper triangular, positive diagonal. It squares the condition
/// number, so it is used only where the columns are far from dependent; then it agrees with QR to about 1e-12 and
/// costs a fraction.
pub(crate) fn triangular_factor_by_products(
    signals: &[&[f64]],
    columns: &[(usize, usize)],
    rows: usize,
) -> Option<DMatrix<f64>> {
    let products = shifted_products(signals, columns, rows);
    let n = columns.len();
    for s in 0..signals.len() {
        let squares = || (0..n).filter(|j| columns[*j].0 == s).map(|j| products[(j, j)]);
        let (least, most) = (squares().fold(f64::INFINITY, f64::min), squares().fold(0.0, f64::max));
        if !(least.is_finite() && least > 0.0 && least >= LEAST_RATIO * most) {
            return None;
        }
    }
    let norms: Vec<f64> = (0..n).map(|j| products[(j, j)].sqrt()).collect();
    // The lower factor, column after column; `left` is what the columns before leave of each square.
    let mut lower = DMatrix::from_fn(n, n, |i, j| if i < j { 0.0 } else { products[(i, j)] / (norms[i] * norms[j]) });
    for j in 0..n {
        let pivot = lower[(j, j)];
        if pivot.is_nan() || pivot < SAFE_PIVOT {
            return None;
        }
        let root = pivot.sqrt();
        let (_, mut rest) = lower.columns_range_pair_mut(..j, j..);
        rest.column_mut(0).rows_mut(j, n - j).unscale_mut(root);
        let done: Vec<f64> = rest.column(0).iter().skip(j).copied().collect();
        for k in 1..n - j {
            let factor = done[k];
            let mut column = rest.column_mut(k);
            for (x, l) in column.rows_mut(j + k, n - j - k).iter_mut().zip(&done[k..]) {
                *x -= factor * l;
            }
        }
    }
    Some(DMatrix::from_fn(n, n, |i, j| if i > j { 0.0 } else { lower[(j, i)] * norms[j] }))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crate::regression::data_triangle::triangular_factor;
    use crumple_numerics::estimation::random::uniform_at;

    fn noisy(stream: usize, samples: usize) -> Vec<f64> {
        let mut y = vec![0.0; samples];
        for k in 2..samples {
            y[k] = 1.2 * y[k - 1] - 0.6 * y[k - 2] + uniform_at(stream, k) - 0.5;
        }
        y
    }

    #[test]
    fn the_factor_is_that_of_qr_up_to_signs() {
        let (a, b) = (noisy(1, 900), noisy(2, 900));
        let columns: Vec<(usize, usize)> = [(0, 6), (0, 0), (1, 0), (1, 6)]
            .into_iter()
            .flat_map(|(s, from)| (0..6).map(move |k| (s, from + k)))
            .collect();
        let rows = 900 - 11;
        let fast = triangular_factor_by_products(&[&a, &b], &columns, rows).unwrap();
        let stretches: Vec<(&[f64], usize)> =
            columns.iter().map(|(s, from)| (if *s == 0 { &a[..] } else { &b[..] }, *from)).collect();
        let exact = triangular_factor(&stretches, rows).matrix();
        // Rounding times the square of a condition number of about ten, relative to norms of about 25.
        assert!((fast.map(f64::abs) - exact.map(f64::abs)).amax() < 1e-11);
    }

    #[test]
    fn dependent_silent_and_fading_columns_are_left_to_qr() {
        let wave: Vec<f64> = (0..300).map(|k| (0.3 * f64::from(k)).cos()).collect();
        let columns = [(0, 0), (0, 1), (0, 2)];
        assert!(triangular_factor_by_products(&[&wave], &columns, 200).is_none());
        assert!(triangular_factor_by_products(&[&[0.0; 300]], &columns, 200).is_none());
        let fading: Vec<f64> = (0..300).map(|k| (-f64::from(k)).exp() * (uniform_at(1, k as usize) + 0.1)).collect();
        assert!(triangular_factor_by_products(&[&fading], &[(0, 0), (0, 5)], 200).is_none());
    }
}

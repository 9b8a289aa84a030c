//! Non-negative least squares from the normal equations, for starting values.
//!
//! Springs and dampers are not negative: where a regression on measured motion would make one so, it belongs at zero
//! and the others change. Half the digits are lost in the normal equations; what follows is a fit that starts from
//! here.

use nalgebra::{DMatrix, DVector};

/// `x >= 0` that minimises `x' G x - 2 b' x`, by the active-set method of Lawson and Hanson (1974).
///
/// `gram` is small and scaled to a diagonal of ones by the caller; squaring the condition is fine for a start that is
/// refined afterwards. Ends after a bounded number of exchanges with the best point so far.
pub fn nonnegative_least_squares(gram: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let n = b.len();
    let mut x = DVector::zeros(n);
    let mut free = vec![false; n];
    for _ in 0..4 * n {
        let slope = b - gram * &x;
        let entering =
            (0..n).filter(|&i| !free[i] && slope[i] > 1e-12 * b.amax()).max_by(|&i, &j| slope[i].total_cmp(&slope[j]));
        let Some(entering) = entering else { break };
        free[entering] = true;
        loop {
            let set: Vec<usize> = (0..n).filter(|&i| free[i]).collect();
            let part = DMatrix::from_fn(set.len(), set.len(), |i, j| {
                gram[(set[i], set[j])] + if i == j { 1e-13 } else { 0.0 }
            });
            let right = DVector::from_fn(set.len(), |i, _| b[set[i]]);
            let Some(solution) = part.cholesky().map(|c| c.solve(&right)) else {
                free[entering] = false;
                return x;
            };
            // As far as the first that would turn negative.
            let blocking = (0..set.len())
                .filter(|&i| solution[i] <= 0.0)
                .map(|i| (x[set[i]] / (x[set[i]] - solution[i]), i))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((share, place)) = blocking else {
                for (i, &k) in set.iter().enumerate() {
                    x[k] = solution[i];
                }
                break;
            };
            let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
            for (i, &k) in set.iter().enumerate() {
                x[k] += share * (solution[i] - x[k]);
            }
            x[set[place]] = 0.0;
            free[set[place]] = false;
            if set.len() == 1 {
                break;
            }
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_unconstrained_solution_where_it_is_positive_and_the_border_elsewhere() {
        let gram = DMatrix::from_row_slice(2, 2, &[1.0, 0.5, 0.5, 1.0]);
        let inside = nonnegative_least_squares(&gram, &DVector::from_vec(vec![1.0, 1.0]));
        // 2/3 each.
        assert!((inside[0] - 2.0 / 3.0).abs() < 1e-12 && (inside[1] - 2.0 / 3.0).abs() < 1e-12);
        let border = nonnegative_least_squares(&gram, &DVector::from_vec(vec![1.0, 0.1]));
        assert!((border[0] - 1.0).abs() < 1e-12 && border[1] == 0.0);
    }
}

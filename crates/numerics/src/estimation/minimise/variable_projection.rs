//! Nonlinear least squares where most unknowns are linear: variable projection, a problem for the bounded
//! Levenberg-Marquardt of this room.
//!
//! The model is `y = known(theta) + B(theta) c`. For a given `theta` the best `c` is a linear least-squares problem, so
//! the search runs over `theta` alone: `min over theta of |(I - Q Q') (y - known)|²`, `Q` an orthonormal basis of the
//! columns of `B`. [`evaluate`] solves the linear part, [`projected_jacobian`] differentiates the projected residual,
//! [`minimize`] descends. Accuracy: coefficients to rounding times the condition of the scaled columns; the minimum to
//! the square root of the cost tolerance (1e-13) in `theta`, or to the gradient tolerance of [`Stop`], whichever ends
//! the search. Local: it depends on the start.

use crate::linalg::dot;
use nalgebra::DMatrix;

use super::StopReason;
use super::levenberg_marquardt::{Bounds, Descent, LeastSquares, descent};

/// A column that is this much shorter after what others explain is removed is taken for dependent on them.
const DEPENDENT: f64 = 1e-11;

/// Relative decrease of the loss that is not worth another step.
const COST_TOLERANCE: f64 = 1e-13;

/// Residual of a perfect fit, relative to the targets: rounding.
const EXACT: f64 = 1e-15;

/// A model `y = known(theta) + basis(theta) c`, the same basis for every output, each output with its own `c`.
pub trait Separable: Sync {
    /// Measured outputs, each of the same length.
    fn targets(&self) -> &[Vec<f64>];

    /// Lower and upper bounds of every nonlinear parameter.
    fn bounds(&self) -> Vec<(f64, f64)>;

    /// Basis signals, and the part without free coefficients if there is one (for every output). `None`: the response
    /// has left the range of `f64` or the parameters make no model.
    fn basis(&self, theta: &[f64]) -> Option<Basis>;

    /// Derivatives of `known + basis c` by every parameter, output after output in one signal each; `coefficients` has
    /// one column per output. `None` as above.
    fn sensitivities(&self, theta: &[f64], coefficients: &DMatrix<f64>) -> Option<Vec<Vec<f64>>>;
}

/// The signals that a model combines linearly, at one `theta`; all of the length of the targets.
pub struct Basis {
    /// Signals.
    pub columns: Vec<Vec<f64>>,
    /// Part without free coefficients, per output; empty: none.
    pub known: Vec<Vec<f64>>,
}

/// Where a search ended: a stationary point, or the best point seen; `stop` tells which.
#[derive(Debug, Clone)]
pub struct SeparableFit {
    /// Nonlinear unknowns.
    pub theta: Vec<f64>,
    /// One column per output.
    pub coefficients: DMatrix<f64>,
    /// Residuals, output after output.
    pub residual: Vec<f64>,
    /// Sum of squared residuals.
    pub cost: f64,
    /// Unknowns that stand on a bound beyond which the cost falls.
    pub on_bound: Vec<bool>,
    /// Steps tried.
    pub iterations: u32,
    /// Evaluations of the basis and of the sensitivities.
    pub evaluations: u64,
    /// Why the descent ended.
    pub stop: StopReason,
}

/// Everything known at one point.
pub struct Point {
    /// Linear unknowns, one column per output.
    pub coefficients: DMatrix<f64>,
    /// Residuals, output after output.
    pub residual: Vec<f64>,
    /// Their sum of squares.
    pub cost: f64,
    /// Orthonormal basis of the span of the columns.
    q: Vec<Vec<f64>>,
}

/// Solves the linear part at `theta`: orthonormal columns by Gram-Schmidt with reorthogonalisation, each first scaled
/// to norm 1; a dependent column (what others leave of it is below 1e-11 of its norm) gets the coefficient 0. `None`
/// where a signal, a coefficient or the cost is not finite.
pub fn evaluate(problem: &impl Separable, theta: &[f64]) -> Option<Point> {
    let Basis { columns, known } = problem.basis(theta)?;
    let targets = problem.targets();
    let count = columns.len();
    let mut q: Vec<Vec<f64>> = Vec::with_capacity(count);
    // Column j = norm_j * sum_i r[i][j] q_i, i over the kept columns.
    let mut r = vec![Vec::new(); count];
    let mut norms = vec![0.0; count];
    let mut kept = Vec::with_capacity(count);
    for (j, mut column) in columns.into_iter().enumerate() {
        let square = dot(&column, &column);
        if !square.is_finite() {
            return None;
        }
        norms[j] = square.sqrt();
        if norms[j] == 0.0 {
            continue;
        }
        column.iter_mut().for_each(|x| *x /= norms[j]);
        let mut entries = vec![0.0; q.len()];
        let mut rest = 1.0;
        for pass in 0..2 {
            // Where a tenth and more is left, one pass is orthogonal to ten units in the last place.
            if pass > 0 && rest > 0.1 {
                break;
            }
            for (entry, q) in entries.iter_mut().zip(&q) {
                let part = dot(q, &column);
                *entry += part;
                for (x, q) in column.iter_mut().zip(q) {
                    *x -= part * q;
                }
            }
            rest = dot(&column, &column).sqrt();
        }
        if rest <= DEPENDENT {
            continue;
        }
        column.iter_mut().for_each(|x| *x /= rest);
        entries.push(rest);
        r[j] = entries;
        kept.push(j);
        q.push(column);
    }
    let mut coefficients = DMatrix::zeros(count, targets.len());
    let mut residual = Vec::with_capacity(targets.iter().map(Vec::len).sum());
    for (output, target) in targets.iter().enumerate() {
        let mut rest = target.clone();
        if let Some(known) = known.get(output) {
            for (rest, known) in rest.iter_mut().zip(known) {
                *rest -= known;
            }
        }
        let mut parts = vec![0.0; q.len()];
        for _ in 0..2 {
            for (part, q) in parts.iter_mut().zip(&q) {
                let p = dot(q, &rest);
                *part += p;
                for (x, q) in rest.iter_mut().zip(q) {
                    *x -= p * q;
                }
            }
        }
        // Back substitution.
        for (i, &j) in kept.iter().enumerate().rev() {
            let c = parts[i] / r[j][i];
            for (part, entry) in parts[..i].iter_mut().zip(&r[j]) {
                *part -= c * entry;
            }
            coefficients[(j, output)] = c / norms[j];
        }
        residual.extend(rest);
    }
    let cost = dot(&residual, &residual);
    (cost.is_finite() && coefficients.iter().all(|c: &f64| c.is_finite())).then_some(Point {
        coefficients,
        residual,
        cost,
        q,
    })
}

/// The Jacobian of the residual after Kaufman: `-(I - Q Q') d(known + basis c)/dtheta`, one signal per parameter. Its
/// product with the residual is the exact gradient.
pub fn projected_jacobian(problem: &impl Separable, theta: &[f64], point: &Point) -> Option<Vec<Vec<f64>>> {
    let mut jacobian = problem.sensitivities(theta, &point.coefficients)?;
    let samples = problem.targets()[0].len();
    for column in &mut jacobian {
        for block in column.chunks_exact_mut(samples) {
            for q in &point.q {
                let part = dot(q, block);
                for (x, q) in block.iter_mut().zip(q) {
                    *x -= part * q;
                }
            }
        }
        column.iter_mut().for_each(|x| *x = -*x);
        if !dot(column, column).is_finite() {
            return None;
        }
    }
    Some(jacobian)
}

/// When a search stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Steps tried at most.
    pub max_iterations: u32,
    /// Largest cosine between a projected sensitivity and the residual at a stationary point.
    pub gradient: f64,
}

impl Default for Stop {
    fn default() -> Self {
        Self { max_iterations: 200, gradient: 1e-8 }
    }
}

/// A separable problem with its linear unknowns projected out, as the descent sees it.
struct Projected<'a, S>(&'a S);

impl<S: Separable> LeastSquares for Projected<'_, S> {
    type Point = Point;

    fn point(&self, theta: &[f64]) -> Option<Point> {
        evaluate(self.0, theta)
    }

    fn residuals_at<'a>(&self, point: &'a Point) -> &'a [f64] {
        &point.residual
    }

    /// Rounding of the targets.
    fn exact_cost(&self) -> f64 {
        EXACT * EXACT * self.0.targets().iter().map(|y| dot(y, y)).sum::<f64>()
    }

    fn sensitivities_at(&self, theta: &[f64], point: &Point, out: &mut DMatrix<f64>) -> bool {
        let Some(jacobian) = projected_jacobian(self.0, theta, point) else { return false };
        for (mut out, column) in out.column_iter_mut().zip(&jacobian) {
            out.copy_from_slice(column);
        }
        true
    }
}

/// Minimises the sum of squared residuals from `start` on, by the descent of
/// [`levenberg_marquardt`](super::levenberg_marquardt). `None` if the start itself is not finite.
///
/// Golub & Pereyra, SIAM J. Numer. Anal. 10, 1973; Kaufman, BIT 15, 1975. Cost of an iteration: one evaluation of the
/// basis, one of the sensitivities, `2 rows (unknowns + columns)²` for the orthogonalisation.
pub fn minimize(problem: &impl Separable, start: &[f64], stop: Stop) -> Option<SeparableFit> {
    let (lower, upper) = problem.bounds().into_iter().unzip();
    let bounds =
        Bounds { lower, upper, max_iterations: stop.max_iterations, cost_tolerance: COST_TOLERANCE, slow: 0.0 };
    let Descent { theta, point, cost, on_bound, iterations, evaluations, stop, .. } =
        descent(&Projected(problem), start, &bounds, stop.gradient, false)?;
    let Point { coefficients, residual, .. } = point;
    Some(SeparableFit { theta, coefficients, residual, cost, on_bound, iterations, evaluations, stop })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    /// Two real exponentials, the textbook case.
    struct Decays {
        y: Vec<Vec<f64>>,
        high: f64,
    }

    impl Separable for Decays {
        fn targets(&self) -> &[Vec<f64>] {
            &self.y
        }
        fn bounds(&self) -> Vec<(f64, f64)> {
            vec![(0.0, self.high); 2]
        }
        fn basis(&self, theta: &[f64]) -> Option<Basis> {
            let columns =
                theta.iter().map(|r| (0..self.y[0].len()).map(|k| (-r * k as f64 * 0.1).exp()).collect()).collect();
            Some(Basis { columns, known: Vec::new() })
        }
        fn sensitivities(&self, theta: &[f64], c: &DMatrix<f64>) -> Option<Vec<Vec<f64>>> {
            let column = |i: usize| {
                let r = theta[i];
                let derivative = move |k: usize| -(k as f64) * 0.1 * (-r * k as f64 * 0.1).exp();
                (0..self.y.len())
                    .flat_map(|output| (0..self.y[0].len()).map(move |k| c[(i, output)] * derivative(k)))
                    .collect()
            };
            Some((0..2).map(column).collect())
        }
    }

    fn two_outputs() -> Vec<Vec<f64>> {
        let y = |a: f64, b: f64| {
            (0..60).map(move |k| a * (-0.5 * f64::from(k) * 0.1).exp() + b * (-2.0 * f64::from(k) * 0.1).exp())
        };
        vec![y(1.0, -3.0).collect(), y(0.5, 2.0).collect()]
    }

    #[test]
    fn clean_data_give_rates_and_amplitudes_of_all_outputs() {
        let fit = minimize(&Decays { y: two_outputs(), high: 9.0 }, &[0.1, 5.0], Stop::default()).unwrap();
        assert!((fit.theta[0] - 0.5).abs() < 1e-10 && (fit.theta[1] - 2.0).abs() < 1e-10, "{:?}", fit.theta);
        assert!((fit.coefficients[(1, 0)] + 3.0).abs() < 1e-9);
        assert!(fit.iterations < 20, "{}", fit.iterations);
    }

    #[test]
    fn bound_and_limit_are_answers() {
        let fit = minimize(&Decays { y: two_outputs(), high: 1.5 }, &[0.1, 1.0], Stop::default()).unwrap();
        assert_eq!((fit.on_bound, fit.theta[1]), (vec![false, true], 1.5));
        assert_ne!(fit.stop, StopReason::IterationLimit);
        let stop = Stop { max_iterations: 1, ..Stop::default() };
        let fit = minimize(&Decays { y: two_outputs(), high: 9.0 }, &[0.1, 5.0], stop).unwrap();
        assert_eq!((fit.stop, fit.iterations), (StopReason::IterationLimit, 1));
    }

    #[test]
    fn coinciding_columns_do_not_break_it() {
        assert!(evaluate(&Decays { y: two_outputs(), high: 9.0 }, &[1.0, 1.0]).unwrap().cost.is_finite());
    }
}

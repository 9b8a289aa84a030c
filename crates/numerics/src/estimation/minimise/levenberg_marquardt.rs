//! Bounded Levenberg-Marquardt for any number of parameters: the one descent of all least-squares problems.
//!
//! Minimises `sum r_i(theta)²` within `lower <= theta <= upper` on the sensitivities that the problem gives. Unknowns
//! should be of size one: the caller scales. Each iteration solves `min |J d + r|² + lambda |D d|²` by QR of the
//! triangle of `J`, never by normal equations; `D` has the largest column norms seen (Marquardt), `lambda` follows
//! Nielsen's gain ratio. An unknown on a bound beyond which the cost falls is fixed for the step, and no step leaves
//! the box. Local: the result depends on the start.
//!
//! Madsen, Nielsen, Tingleff, *Methods for non-linear least squares problems*, 2nd ed., 2004, section 3.2.

use nalgebra::DMatrix;

use crate::estimation::minimise::StopReason;
use crate::linalg::{TriangularFactor, dot};

/// Residuals at a point; `false` if the model has no finite response there.
pub trait Response: Sync {
    /// Number of residuals.
    fn rows(&self) -> usize;
    /// Fills `out`.
    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool;
    /// Sum of squares at which the model is the record, [`StopReason::PerfectFit`]: nothing is left to descend for.
    fn exact(&self) -> f64 {
        0.0
    }
    /// Sum of squares below which nobody can tell models apart: below it a descent goes on only while it falls by
    /// half in [`Bounds::SLOW_STEPS`] steps, as one towards the exact model does.
    fn fine(&self) -> f64 {
        0.0
    }
    /// Fills the first columns of `out` with the derivatives of the residuals; `false` where they are not finite.
    fn sensitivities(&self, theta: &[f64], out: &mut DMatrix<f64>) -> bool;
}

/// What a descent asks of a problem. Every [`Response`] is one, its residuals being all that is known at a point; a
/// problem whose sensitivities need more than `theta` keeps that in its points.
pub(super) trait LeastSquares: Sync {
    /// What is known at a point.
    type Point;
    /// What is known at `theta`; `None` if the model has no finite response there.
    fn point(&self, theta: &[f64]) -> Option<Self::Point>;
    /// The residuals at a point.
    fn residuals_at<'a>(&self, point: &'a Self::Point) -> &'a [f64];
    /// As [`Response::exact`].
    fn exact_cost(&self) -> f64;
    /// As [`Response::fine`].
    fn fine_cost(&self) -> f64 {
        0.0
    }
    /// As [`Response::sensitivities`].
    fn sensitivities_at(&self, theta: &[f64], point: &Self::Point, out: &mut DMatrix<f64>) -> bool;
}

impl<R: Response> LeastSquares for R {
    type Point = Vec<f64>;

    fn point(&self, theta: &[f64]) -> Option<Vec<f64>> {
        let mut residuals = vec![0.0; self.rows()];
        self.residuals(theta, &mut residuals).then_some(residuals)
    }

    fn residuals_at<'a>(&self, point: &'a Vec<f64>) -> &'a [f64] {
        point
    }

    fn exact_cost(&self) -> f64 {
        self.exact()
    }

    fn fine_cost(&self) -> f64 {
        self.fine()
    }

    fn sensitivities_at(&self, theta: &[f64], _point: &Vec<f64>, out: &mut DMatrix<f64>) -> bool {
        self.sensitivities(theta, out)
    }
}

/// The box to stay in and when to stop.
#[derive(Debug, Clone)]
pub struct Bounds {
    /// Smallest value of each unknown.
    pub lower: Vec<f64>,
    /// Largest value of each unknown.
    pub upper: Vec<f64>,
    /// Steps after which the best point so far is the result.
    pub max_iterations: u32,
    /// Smallest relative decrease of the cost, that of the linear model too, that is worth going on for.
    pub cost_tolerance: f64,
    /// Smallest relative decrease of the cost in [`Bounds::SLOW_STEPS`] steps that is worth going on for; 0: any.
    pub slow: f64,
}

impl Bounds {
    /// Steps after which a descent is asked whether it still gets anywhere.
    pub const SLOW_STEPS: u32 = 20;

    /// The nearest point of the box.
    fn nearest(&self, theta: &[f64]) -> Vec<f64> {
        let limits = self.lower.iter().zip(&self.upper);
        theta.iter().zip(limits).map(|(x, (low, high))| x.clamp(*low, *high)).collect()
    }
}

/// Where a descent ended.
#[derive(Debug, Clone)]
pub struct Optimum {
    /// The unknowns.
    pub theta: Vec<f64>,
    /// Sum of squares.
    pub cost: f64,
    /// Triangle of the sensitivities.
    pub r: DMatrix<f64>,
    /// Unknowns that stand on a bound beyond which the cost falls.
    pub on_bound: Vec<bool>,
    /// Steps tried.
    pub iterations: u32,
    /// Evaluations of the residuals, and of the sensitivities or those for differences.
    pub evaluations: u64,
    /// Why the descent ended.
    pub stop: StopReason,
}

/// Largest cosine between the residuals and a sensitivity that counts as orthogonal: rounding.
const ORTHOGONAL: f64 = 1e-14;
/// Largest step of an unknown, which is of size one, that counts as standing still: rounding.
const STANDING: f64 = 1e-14;
/// Share of the cost that a descent towards the exact model loses in twenty steps at least.
const TOWARDS_EXACT: f64 = 0.5;
/// Damping above which a step is too short to change the cost: rounding is all that is left.
const DAMPING_LIMIT: f64 = 1e12;

/// The linearised problem, reduced by QR: `|J d + r|² = |R d + q|² + rest`.
struct Linear {
    /// Triangle of `[J, r]`.
    triangle: TriangularFactor,
    /// `J' r`.
    gradient: Vec<f64>,
    /// Norms of the columns of `J`.
    norms: Vec<f64>,
}

/// Where a descent stands: its best point and what is known there.
pub(super) struct Descent<P> {
    /// The unknowns.
    pub theta: Vec<f64>,
    /// What the problem knows there.
    pub point: P,
    /// Sum of squares.
    pub cost: f64,
    /// The linearised problem at the last point that has one; the best point, if the descent was to end with it.
    linear: Option<Linear>,
    /// Unknowns that stand on a bound beyond which the cost falls.
    pub on_bound: Vec<bool>,
    /// Steps tried.
    pub iterations: u32,
    /// Evaluations of the residuals, and of the sensitivities or those for differences.
    pub evaluations: u64,
    /// Why the descent ended.
    pub stop: StopReason,
}

/// Descends from `start`, which is moved into the bounds; `None` if it has no finite response. Parameters should be of
/// size one. Method and sources: see the head of this file.
pub fn descend(problem: &impl Response, start: &[f64], bounds: &Bounds) -> Option<Optimum> {
    let Descent { theta, cost, linear, on_bound, iterations, evaluations, stop, .. } =
        descent(problem, start, bounds, ORTHOGONAL, true)?;
    let r = linear?.triangle.matrix().view((0, 0), (theta.len(), theta.len())).into_owned();
    Some(Optimum { theta, cost, r, on_bound, iterations, evaluations, stop })
}

/// The descent of every problem. `orthogonal`: largest cosine between the residuals and a sensitivity at a stationary
/// point. `linearised`: whether its end needs the linearised problem there, which costs the sensitivities once more.
pub(super) fn descent<L: LeastSquares>(
    problem: &L,
    start: &[f64],
    bounds: &Bounds,
    orthogonal: f64,
    linearised: bool,
) -> Option<Descent<L::Point>> {
    let n = start.len();
    let mut theta = bounds.nearest(start);
    let mut point = problem.point(&theta)?;
    let mut cost = square(problem.residuals_at(&point));
    let (mut evaluations, mut iterations) = (1, 0);
    let exact = problem.exact_cost();
    let ended = |cost: f64, iterations: u32| {
        let limit = (iterations >= bounds.max_iterations).then_some(StopReason::IterationLimit);
        if cost <= exact { Some(StopReason::PerfectFit) } else { limit }
    };
    let mut end = ended(cost, iterations);
    if let (Some(stop), false) = (end, linearised) {
        let on_bound = vec![false; n];
        return Some(Descent { theta, point, cost, linear: None, on_bound, iterations, evaluations, stop });
    }
    let mut matrix = DMatrix::zeros(problem.residuals_at(&point).len(), n + 1);
    let mut linear = linearise(problem, &theta, &point, &mut matrix, &mut evaluations)?;
    let mut on_bound = fixed_at_bound(&theta, &linear, bounds);
    let mut scale = vec![0.0; n];
    let (mut lambda, mut growth) = (1e-3, 2.0);
    let mut cost_before = cost;
    let stop = loop {
        if let Some(reason) = end.or_else(|| ended(cost, iterations)) {
            break reason;
        }
        for (scale, norm) in scale.iter_mut().zip(&linear.norms) {
            *scale = norm.max(*scale);
        }
        let size = cost.sqrt();
        if (0..n).all(|i| on_bound[i] || linear.gradient[i].abs() <= orthogonal * linear.norms[i] * size) {
            break StopReason::GradientConverged;
        }
        if iterations > 0 && iterations % Bounds::SLOW_STEPS == 0 {
            let slow = if cost < problem.fine_cost() { bounds.slow.max(TOWARDS_EXACT) } else { bounds.slow };
            if cost > (1.0 - slow) * cost_before {
                break StopReason::SlowDescent;
            }
            cost_before = cost;
        }
        iterations += 1;
        let Some(step) = damped_step(&linear, &scale, lambda, &on_bound, &theta, bounds) else {
            lambda *= growth;
            growth *= 2.0;
            continue;
        };
        let next = bounds.nearest(&theta.iter().zip(&step).map(|(x, d)| x + d).collect::<Vec<_>>());
        let step: Vec<f64> = next.iter().zip(&theta).map(|(next, x)| next - x).collect();
        if step.iter().all(|d| d.abs() <= STANDING) {
            break StopReason::StepConverged;
        }
        let predicted = predicted_decrease(&linear, &step);
        let trial = problem.point(&next).map(|point| (square(problem.residuals_at(&point)), point));
        evaluations += 1;
        let small = bounds.cost_tolerance * cost;
        match trial.filter(|(next_cost, _)| *next_cost < cost && predicted > 0.0) {
            Some((next_cost, next_point)) => {
                let decrease = cost - next_cost;
                let done = decrease <= small && predicted <= small;
                end = done.then_some(StopReason::CostConverged).or_else(|| ended(next_cost, iterations));
                if end.is_none() || linearised {
                    let there = linearise(problem, &next, &next_point, &mut matrix, &mut evaluations);
                    // A finite cost and no finite sensitivities: stay with the last point that has both.
                    let Some(there) = there else { break StopReason::NoImprovement };
                    linear = there;
                }
                (theta, point, cost) = (next, next_point, next_cost);
                on_bound = fixed_at_bound(&theta, &linear, bounds);
                lambda *= (1.0_f64 / 3.0).max(1.0 - (2.0 * decrease / predicted - 1.0).powi(3));
                growth = 2.0;
            }
            None if predicted <= small => break StopReason::CostConverged,
            None if lambda > DAMPING_LIMIT => break StopReason::NoImprovement,
            None => {
                lambda *= growth;
                growth *= 2.0;
            }
        }
    };
    Some(Descent { theta, point, cost, linear: Some(linear), on_bound, iterations, evaluations, stop })
}

/// Sensitivities and residuals at `theta`, reduced to a triangle; `None` where one of them is not finite. `matrix`, of
/// one column more than there are unknowns, is overwritten. Counts evaluations.
fn linearise<L: LeastSquares>(
    problem: &L,
    theta: &[f64],
    point: &L::Point,
    matrix: &mut DMatrix<f64>,
    evaluations: &mut u64,
) -> Option<Linear> {
    let (n, residuals) = (theta.len(), problem.residuals_at(point));
    matrix.fill(0.0);
    if !problem.sensitivities_at(theta, point, matrix) {
        return None;
    }
    *evaluations += 1;
    matrix.column_mut(n).copy_from_slice(residuals);
    let mut triangle = TriangularFactor::new(n + 1);
    // Never J'J: it would square the condition of the sensitivities.
    triangle.push(residuals.len(), matrix.as_mut_slice());
    let reduced = triangle.column(n);
    let gradient = (0..n).map(|i| dot(triangle.column(i), &reduced[..=i])).collect();
    let norms: Vec<f64> = (0..n).map(|i| square(triangle.column(i)).sqrt()).collect();
    (norms.iter().chain(reduced).all(|x| x.is_finite())).then_some(Linear { triangle, gradient, norms })
}

/// Sum of squares.
fn square(x: &[f64]) -> f64 {
    dot(x, x)
}

/// How much less than `|q|²` the linearised problem leaves after a step.
fn predicted_decrease(linear: &Linear, step: &[f64]) -> f64 {
    let before = &linear.triangle.column(step.len())[..step.len()];
    let mut after = before.to_vec();
    for (j, d) in step.iter().enumerate() {
        after.iter_mut().zip(linear.triangle.column(j)).for_each(|(x, r)| *x += r * d);
    }
    square(before) - square(&after)
}

/// The derivatives of the residuals at a minimum; `None` where they are not finite.
pub fn derivatives(problem: &impl Response, theta: &[f64]) -> Option<DMatrix<f64>> {
    let mut jacobian = DMatrix::zeros(problem.rows(), theta.len());
    problem.sensitivities(theta, &mut jacobian).then_some(jacobian)
}

/// Unknowns on a bound with the descent direction pointing outwards.
fn fixed_at_bound(theta: &[f64], linear: &Linear, bounds: &Bounds) -> Vec<bool> {
    let gradient = &linear.gradient;
    (0..theta.len())
        .map(|i| {
            (theta[i] <= bounds.lower[i] && gradient[i] >= 0.0) || (theta[i] >= bounds.upper[i] && gradient[i] <= 0.0)
        })
        .collect()
}

/// The damped step inside the box: an unknown that would leave it moves to the bound, and the others are solved for
/// again given that. `None` where the step is not finite.
fn damped_step(
    linear: &Linear,
    scale: &[f64],
    lambda: f64,
    on_bound: &[bool],
    theta: &[f64],
    bounds: &Bounds,
) -> Option<Vec<f64>> {
    let n = theta.len();
    let mut fixed: Vec<Option<f64>> = on_bound.iter().map(|fixed| fixed.then_some(0.0)).collect();
    let mut block = vec![0.0; 2 * n * (n + 1)];
    loop {
        // Columns of `[R, -q; sqrt(lambda) D, 0]`; what is fixed goes to the right.
        block.fill(0.0);
        let (columns, target) = block.split_at_mut(2 * n * n);
        target.iter_mut().zip(&linear.triangle.column(n)[..n]).for_each(|(t, q)| *t = -q);
        for (j, column) in columns.chunks_exact_mut(2 * n).enumerate() {
            let r = linear.triangle.column(j);
            match fixed[j] {
                Some(distance) => target.iter_mut().zip(r).for_each(|(t, r)| *t -= r * distance),
                None => column[..r.len()].copy_from_slice(r),
            }
            let weight = if fixed[j].is_none() && scale[j] > 0.0 { scale[j] } else { 1.0 };
            column[n + j] = lambda.sqrt() * weight;
        }
        let mut damped = TriangularFactor::new(n + 1);
        damped.push(2 * n, &mut block);
        let mut step = damped.back_substitution()?;
        let mut leaves = false;
        for i in 0..n {
            let (down, up) = (bounds.lower[i] - theta[i], bounds.upper[i] - theta[i]);
            match fixed[i] {
                Some(distance) => step[i] = distance,
                None if step[i] < down || step[i] > up => {
                    fixed[i] = Some(step[i].clamp(down, up));
                    leaves = true;
                }
                None => {}
            }
        }
        // At most as many rounds as unknowns: each fixes one more.
        if !leaves {
            return Some(step);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `exp(-x)`: each step of Gauss and Newton is one, and lowers the cost by `exp(-2)`.
    struct Decay;

    impl Response for Decay {
        fn rows(&self) -> usize {
            1
        }

        fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
            out[0] = (-theta[0]).exp();
            true
        }

        fn sensitivities(&self, theta: &[f64], out: &mut DMatrix<f64>) -> bool {
            out[(0, 0)] = -(-theta[0]).exp();
            true
        }
    }

    #[test]
    fn a_descent_that_gains_too_little_in_twenty_steps_ends() {
        let end = |slow: f64| {
            let bounds = Bounds { lower: vec![0.0], upper: vec![1e3], max_iterations: 50, cost_tolerance: 0.0, slow };
            descend(&Decay, &[0.0], &bounds).map(|optimum| (optimum.stop, optimum.iterations))
        };
        // Twenty steps lower the cost by exp(-40): too little for one who asks for all of it alone.
        assert_eq!(end(1.0), Some((StopReason::SlowDescent, Bounds::SLOW_STEPS)));
        for slow in [0.0, 1e-2, 0.99] {
            assert_eq!(end(slow), Some((StopReason::IterationLimit, 50)));
        }
    }
}

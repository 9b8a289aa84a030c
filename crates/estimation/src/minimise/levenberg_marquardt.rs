//! Bounded Levenberg-Marquardt for any number of parameters.
//!
//! Minimises `sum r_i(theta)²` within `lower <= theta <= upper`. Sensitivities are the problem's own where it has them,
//! else differences (one-sided in the descent: relative error near 1e-8; central at the minimum: near 1e-10). Unknowns
//! should be of size one: the caller scales. Each iteration solves `min |J d + r|² + lambda |D d|²` by QR of the
//! triangle of `J`, never by normal equations; `D` has the largest column norms seen (Marquardt), `lambda` follows
//! Nielsen's gain ratio. Local: the result depends on the start. Four unknowns have a version of fixed size,
//! [`levenberg_marquardt_4`](super::levenberg_marquardt_4).
//!
//! Madsen, Nielsen, Tingleff, *Methods for non-linear least squares problems*, 2nd ed., 2004, section 3.2.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::stop_reason::StopReason;

/// Residuals at a point; `false` if the model has no finite response there.
pub trait Response: Sync {
    /// Number of residuals.
    fn rows(&self) -> usize;
    /// Fills `out`.
    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool;
    /// Sum of squares at which the model is the record: nothing is left to descend for.
    fn exact(&self) -> f64 {
        0.0
    }
    /// Fills the first columns of `out` with the derivatives of the residuals; `None` if the problem has none of its
    /// own and differences must do, `Some(false)` where they are not finite.
    fn sensitivities(&self, _theta: &[f64], _out: &mut DMatrix<f64>) -> Option<bool> {
        None
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
    /// Smallest relative decrease of the cost worth going on for.
    pub cost_tolerance: f64,
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
    /// Evaluations of the residuals, those for differences too.
    pub evaluations: u64,
    /// Why the descent ended.
    pub stop: StopReason,
}

/// Difference step in units of the parameters, which are of size one: rounding of the response (1e-15) over it and its
/// square meet near 1e-8 of the sensitivities.
const DIFFERENCE: f64 = 1e-7;
/// Step of the central differences at a minimum, in the same units.
const CENTRAL_DIFFERENCE: f64 = 1e-5;

/// The linearised problem, reduced by QR: `|J d + r|² = |R d + q|² + rest`.
struct Linear {
    r: DMatrix<f64>,
    q: DVector<f64>,
}

/// Descends from `start`, which is moved into the bounds; `None` if it has no finite response. Parameters should be of
/// size one. Method and sources: see the head of this file.
pub fn descend(problem: &impl Response, start: &[f64], bounds: &Bounds) -> Option<Optimum> {
    let n = start.len();
    let clamp =
        |theta: &[f64]| -> Vec<f64> { (0..n).map(|i| theta[i].clamp(bounds.lower[i], bounds.upper[i])).collect() };
    let mut theta = clamp(start);
    let mut residuals = vec![0.0; problem.rows()];
    let mut next_residuals = residuals.clone();
    let cost_of = |r: &[f64]| r.iter().map(|x| x * x).sum::<f64>();
    if !problem.residuals(&theta, &mut residuals) {
        return None;
    }
    let mut cost = cost_of(&residuals);
    let mut evaluations = 1;
    let mut linear = linearise(problem, &theta, &residuals, bounds, &mut evaluations)?;
    let mut scale = DVector::zeros(n);
    let (mut lambda, mut growth) = (1e-3, 2.0);
    let mut iterations = 0;
    let stop = loop {
        for i in 0..n {
            scale[i] = linear.r.column(i).norm().max(scale[i]);
        }
        let on_bound = fixed_at_bound(&theta, &linear, bounds);
        let gradient = linear.r.tr_mul(&linear.q);
        let size = cost.sqrt();
        if (0..n).filter(|&i| !on_bound[i]).all(|i| gradient[i].abs() <= 1e-14 * linear.r.column(i).norm() * size) {
            break StopReason::GradientConverged;
        }
        if cost <= problem.exact() {
            break StopReason::CostConverged;
        }
        if iterations >= bounds.max_iterations {
            break StopReason::IterationLimit;
        }
        iterations += 1;
        let Some(step) = damped_step(&linear, &scale, lambda, &on_bound, &theta, bounds) else {
            lambda *= growth;
            growth *= 2.0;
            continue;
        };
        let next = clamp(&(0..n).map(|i| theta[i] + step[i]).collect::<Vec<_>>());
        let step = DVector::from_fn(n, |i, _| next[i] - theta[i]);
        if step.amax() <= 1e-14 {
            break StopReason::StepConverged;
        }
        let predicted = linear.q.norm_squared() - (&linear.r * &step + &linear.q).norm_squared();
        evaluations += 1;
        let next_cost =
            if problem.residuals(&next, &mut next_residuals) { cost_of(&next_residuals) } else { f64::INFINITY };
        let decrease = cost - next_cost;
        let small = bounds.cost_tolerance * cost;
        if decrease > 0.0 && predicted > 0.0 {
            let gain = decrease / predicted;
            let done = decrease <= small && predicted <= small;
            std::mem::swap(&mut residuals, &mut next_residuals);
            theta = next;
            cost = next_cost;
            let Some(new) = linearise(problem, &theta, &residuals, bounds, &mut evaluations) else {
                break StopReason::StepConverged;
            };
            linear = new;
            lambda *= (1.0_f64 / 3.0).max(1.0 - (2.0 * gain - 1.0).powi(3));
            growth = 2.0;
            if done {
                break StopReason::CostConverged;
            }
        } else {
            if predicted <= small || lambda > 1e12 {
                break StopReason::CostConverged;
            }
            lambda *= growth;
            growth *= 2.0;
        }
    };
    let on_bound = fixed_at_bound(&theta, &linear, bounds);
    Some(Optimum { theta, cost, r: linear.r, on_bound, iterations, evaluations, stop })
}

/// Sensitivities and residuals at `theta`, reduced to a triangle; `None` where one of them is not finite. Counts
/// evaluations.
fn linearise(
    problem: &impl Response,
    theta: &[f64],
    residuals: &[f64],
    bounds: &Bounds,
    evaluations: &mut u64,
) -> Option<Linear> {
    let (n, rows) = (theta.len(), residuals.len());
    let mut matrix = DMatrix::zeros(rows, n + 1);
    let analytic = problem.sensitivities(theta, &mut matrix);
    if analytic == Some(false) {
        return None;
    }
    *evaluations += u64::from(analytic.is_some());
    if analytic.is_none() {
        let columns: Vec<(Option<Vec<f64>>, u64)> =
            (0..n).into_par_iter().map(|i| difference(problem, theta, residuals, bounds, i)).collect();
        for (i, (column, spent)) in columns.into_iter().enumerate() {
            *evaluations += spent;
            matrix.column_mut(i).copy_from_slice(&column?);
        }
    }
    matrix.column_mut(n).copy_from_slice(residuals);
    let triangle = matrix.qr().r();
    let kept = n.min(triangle.nrows());
    let mut r = DMatrix::zeros(n, n);
    let mut q = DVector::zeros(n);
    r.view_mut((0, 0), (kept, n)).copy_from(&triangle.view((0, 0), (kept, n)));
    q.rows_mut(0, kept).copy_from(&triangle.view((0, n), (kept, 1)));
    (r.iter().chain(q.iter()).all(|x| x.is_finite())).then_some(Linear { r, q })
}

/// The derivatives of the residuals at a minimum from central differences, one-sided at a bound; `None` where one has
/// no finite response. Off by a third of the squared step times the third derivative, and rounding over the step: both
/// near 1e-10.
pub fn central_differences(problem: &impl Response, theta: &[f64], bounds: &Bounds) -> Option<DMatrix<f64>> {
    let rows = problem.rows();
    let mut jacobian = DMatrix::zeros(rows, theta.len());
    let mut moved = theta.to_vec();
    let (mut above, mut below) = (vec![0.0; rows], vec![0.0; rows]);
    for j in 0..theta.len() {
        let up = (theta[j] + CENTRAL_DIFFERENCE).min(bounds.upper[j]);
        let down = (theta[j] - CENTRAL_DIFFERENCE).max(bounds.lower[j]);
        for (coordinate, out) in [(up, &mut above), (down, &mut below)] {
            moved[j] = coordinate;
            if !problem.residuals(&moved, out) {
                return None;
            }
        }
        moved[j] = theta[j];
        for (k, (a, b)) in above.iter().zip(&below).enumerate() {
            jacobian[(k, j)] = (a - b) / (up - down);
        }
    }
    Some(jacobian)
}

/// The derivatives of the residuals at a minimum: the problem's own, or central differences where it has none.
pub fn derivatives(problem: &impl Response, theta: &[f64], bounds: &Bounds) -> Option<DMatrix<f64>> {
    let mut jacobian = DMatrix::zeros(problem.rows(), theta.len());
    if problem.sensitivities(theta, &mut jacobian) == Some(true) {
        return Some(jacobian);
    }
    central_differences(problem, theta, bounds)
}

/// The derivative by one of theta from a difference, if there is a finite response on either side, and the evaluations
/// spent.
fn difference(
    problem: &impl Response,
    theta: &[f64],
    residuals: &[f64],
    bounds: &Bounds,
    i: usize,
) -> (Option<Vec<f64>>, u64) {
    let mut moved = theta.to_vec();
    let mut moved_residuals = vec![0.0; residuals.len()];
    // Inwards from a bound, else forwards.
    let forwards = theta[i] + DIFFERENCE <= bounds.upper[i];
    for (spent, step) in (1..).zip(if forwards { [DIFFERENCE, -DIFFERENCE] } else { [-DIFFERENCE, DIFFERENCE] }) {
        moved[i] = theta[i] + step;
        let by = moved[i] - theta[i];
        if problem.residuals(&moved, &mut moved_residuals) {
            return (Some(moved_residuals.iter().zip(residuals).map(|(a, b)| (a - b) / by).collect()), spent);
        }
    }
    (None, 2)
}

/// Unknowns on a bound with the descent direction pointing outwards.
fn fixed_at_bound(theta: &[f64], linear: &Linear, bounds: &Bounds) -> Vec<bool> {
    let gradient = linear.r.tr_mul(&linear.q);
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
    scale: &DVector<f64>,
    lambda: f64,
    on_bound: &[bool],
    theta: &[f64],
    bounds: &Bounds,
) -> Option<DVector<f64>> {
    let n = theta.len();
    let mut fixed: Vec<Option<f64>> = on_bound.iter().map(|fixed| fixed.then_some(0.0)).collect();
    loop {
        let mut stacked = DMatrix::zeros(2 * n, n);
        let mut right = DVector::zeros(2 * n);
        stacked.view_mut((0, 0), (n, n)).copy_from(&linear.r);
        let mut target = -&linear.q;
        for i in 0..n {
            if let Some(distance) = fixed[i] {
                target -= linear.r.column(i) * distance;
                stacked.column_mut(i).fill(0.0);
            }
            let weight = if fixed[i].is_none() && scale[i] > 0.0 { scale[i] } else { 1.0 };
            stacked[(n + i, i)] = lambda.sqrt() * weight;
        }
        right.rows_mut(0, n).copy_from(&target);
        let qr = stacked.qr();
        let mut step = qr.r().solve_upper_triangular(&qr.q().tr_mul(&right))?;
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
        if !leaves {
            return step.iter().all(|x| x.is_finite()).then_some(step);
        }
    }
}

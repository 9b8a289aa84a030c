//! A primal-dual interior-point method for few variables, as the single-mass paper uses one.
//!
//! Minimises `f(x)` subject to equations `c(x) = 0` and linear inequalities `G x + h >= 0`. Variables should be of size
//! one: the tolerance, 1e-8, is absolute on stationarity, complementarity and feasibility alike. Meant for some ten
//! variables: every step takes an eigenvalue decomposition of the whole matrix.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::estimation::minimise::StopReason;

/// Minimise `f(x)` with `c(x) = 0` and `G x + h >= 0`.
pub trait Program {
    /// `f`, its gradient, `c` and its Jacobian; `None` where there is no finite response.
    fn evaluate(&self, x: &DVector<f64>) -> Option<Evaluated>;
}

/// Values and derivatives of a program at a point.
#[derive(Debug, Clone)]
pub struct Evaluated {
    /// Cost `f(x)`.
    pub f: f64,
    /// Its gradient, one entry an unknown.
    pub gradient: DVector<f64>,
    /// A first Hessian of `f`, e.g. that of Gauss and Newton.
    pub hessian: DMatrix<f64>,
    /// Residuals of the equations, `c(x) = 0` at a solution.
    pub c: DVector<f64>,
    /// Derivatives of the equations, one row an equation.
    pub jacobian: DMatrix<f64>,
}

/// Where the method ended.
#[derive(Debug, Clone)]
pub struct InteriorPoint {
    /// The last point.
    pub x: DVector<f64>,
    /// Cost there.
    pub f: f64,
    /// Largest violation of an equation or inequality.
    pub infeasibility: f64,
    /// Steps taken.
    pub iterations: u32,
    /// Evaluations of the program.
    pub evaluations: u64,
    /// Why it ended there.
    pub stop: StopReason,
}

/// Share of the way to a bound that a step may go.
const FRACTION: f64 = 0.995;
/// Optimality and feasibility, in units in which everything is of size one.
const TOLERANCE: f64 = 1e-8;
/// Steps after which the best point so far is the result.
const MAX_ITERATIONS: u32 = 400;

/// Slacks for the inequalities, a logarithmic barrier that falls by `mu <- max(tol/10, min(0.2 mu, mu^1.5))`, damped
/// BFGS for the Hessian of the Lagrangian (begun with the program's own, and again where a step had to be cut), an l1
/// merit function with backtracking, and a multiple of the identity added until the matrix of the step has the right
/// inertia. `g` has one row and `h` one entry an inequality. `None` if the program has no finite value at the start.
///
/// Local, as every method of its kind. Nocedal & Wright, *Numerical Optimization*, 2006, chapter 19.
pub fn interior_point(
    program: &impl Program,
    start: &DVector<f64>,
    (g, h): (&DMatrix<f64>, &DVector<f64>),
) -> Option<InteriorPoint> {
    let (n, m) = (start.len(), h.len());
    let mut x = start.clone();
    let mut current = program.evaluate(&x)?;
    let mut evaluations = 1;
    let equations = current.c.len();
    let mut s = (g * &x + h).map(|value| value.max(1e-2));
    let mut mu = 0.1 * current.f.max(1e-3);
    let mut z = s.map(|s| mu / s);
    let mut y = DVector::<f64>::zeros(equations);
    let mut hessian = current.hessian.clone() + DMatrix::identity(n, n) * 1e-6;
    let mut iterations = 0;
    let residual =
        |current: &Evaluated, x: &DVector<f64>, s: &DVector<f64>, y: &DVector<f64>, z: &DVector<f64>, mu: f64| {
            let stationary = (&current.gradient - current.jacobian.tr_mul(y) - g.tr_mul(z)).amax();
            let size = 1.0 + z.amax().max(y.amax());
            let complementary = s.component_mul(z).add_scalar(-mu).amax();
            let infeasible = current.c.amax().max((g * x + h - s).amax());
            (stationary / size).max(complementary / size).max(infeasible)
        };
    let stop = loop {
        if residual(&current, &x, &s, &y, &z, 0.0) <= TOLERANCE {
            break StopReason::GradientConverged;
        }
        if iterations >= MAX_ITERATIONS {
            break StopReason::IterationLimit;
        }
        while mu > 0.1 * TOLERANCE && residual(&current, &x, &s, &y, &z, mu) <= 10.0 * mu {
            mu = (0.1 * TOLERANCE).max((0.2 * mu).min(mu.powf(1.5)));
        }
        iterations += 1;
        let sigma = z.component_div(&s);
        let slack = g * &x + h - &s;
        let push = s.map(|s| mu / s) - sigma.component_mul(&slack);
        let mut right = DVector::zeros(n + equations);
        right.rows_mut(0, n).copy_from(&(g.tr_mul(&push) - &current.gradient));
        right.rows_mut(n, equations).copy_from(&(-&current.c));
        let curved = &hessian + g.transpose() * DMatrix::from_diagonal(&sigma) * g;
        let Some(solution) = solve(&curved, &current.jacobian, &right) else { break StopReason::StepConverged };
        let dx = solution.rows(0, n).into_owned();
        let next_y = -solution.rows(n, equations);
        let ds = g * &dx + &slack;
        let dz = s.map(|s| mu / s) - &z - sigma.component_mul(&ds);

        let penalty = 1.5 * next_y.amax().max(z.amax()).max(1e-3);
        let reach = |values: &DVector<f64>, step: &DVector<f64>| {
            values.iter().zip(step).filter(|(_, d)| **d < 0.0).map(|(v, d)| -FRACTION * v / d).fold(1.0, f64::min)
        };
        let merit = |at: &Evaluated, x: &DVector<f64>, s: &DVector<f64>| {
            at.f - mu * s.iter().map(|s| s.ln()).sum::<f64>() + penalty * (at.c.lp_norm(1) + (g * x + h - s).lp_norm(1))
        };
        let now = merit(&current, &x, &s);
        let slope = current.gradient.dot(&dx)
            - mu * ds.component_div(&s).sum()
            - penalty * (current.c.lp_norm(1) + slack.lp_norm(1));
        let mut step = reach(&s, &ds);
        let mut accepted = None;
        for _ in 0..40 {
            let (tried, tried_s) = (&x + &dx * step, &s + &ds * step);
            evaluations += 1;
            if let Some(trial) = program.evaluate(&tried)
                && merit(&trial, &tried, &tried_s) <= now + 1e-4 * step * slope.min(0.0) + 1e-15 * now.abs()
            {
                accepted = Some((tried, tried_s, trial));
                break;
            }
            step *= 0.5;
        }
        let Some((next, next_s, trial)) = accepted else { break StopReason::StepConverged };
        z += &dz * reach(&z, &dz);
        y = next_y;
        let moved = &next - &x;
        let change = (&trial.gradient - trial.jacobian.tr_mul(&y)) - (&current.gradient - current.jacobian.tr_mul(&y));
        if step < 0.3 {
            // The model of the curvature was wrong: begun again.
            hessian = &trial.hessian + DMatrix::identity(n, n) * 1e-6;
        } else {
            update(&mut hessian, &moved, &change);
        }
        (x, s, current) = (next, next_s, trial);
        debug_assert_eq!(s.len(), m);
    };
    let below = (g * &x + h).iter().map(|value| (-value).max(0.0)).fold(0.0, f64::max);
    Some(InteriorPoint { f: current.f, infeasibility: current.c.amax().max(below), x, iterations, evaluations, stop })
}

/// `[[W + d I, J'], [J, 0]] [dx, -y] = right`, `d` the least of a row of tens that gives as many negative eigenvalues
/// as there are equations.
fn solve(curved: &DMatrix<f64>, jacobian: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    let (n, equations) = (curved.nrows(), jacobian.nrows());
    let mut correction = 0.0;
    for _ in 0..20 {
        let mut matrix = DMatrix::zeros(n + equations, n + equations);
        matrix.view_mut((0, 0), (n, n)).copy_from(curved);
        for i in 0..n {
            matrix[(i, i)] += correction;
        }
        matrix.view_mut((0, n), (n, equations)).copy_from(&jacobian.transpose());
        matrix.view_mut((n, 0), (equations, n)).copy_from(jacobian);
        if !matrix.iter().all(|value| value.is_finite()) {
            return None;
        }
        let negative = SymmetricEigen::new(matrix.clone()).eigenvalues.iter().filter(|value| **value < 0.0).count();
        if negative == equations
            && let Some(solution) = matrix.lu().solve(right)
            && solution.iter().all(|value| value.is_finite())
        {
            return Some(solution);
        }
        correction = if correction == 0.0 { 1e-8 * curved.amax().max(1e-8) } else { 10.0 * correction };
    }
    None
}

/// BFGS with Powell's damping, so that the matrix stays positive definite.
fn update(hessian: &mut DMatrix<f64>, moved: &DVector<f64>, change: &DVector<f64>) {
    let along = &*hessian * moved;
    let curvature = moved.dot(&along);
    if curvature <= 0.0 || !curvature.is_finite() {
        return;
    }
    let product = moved.dot(change);
    let share = if product >= 0.2 * curvature { 1.0 } else { 0.8 * curvature / (curvature - product) };
    let damped = change * share + &along * (1.0 - share);
    let of_damped = moved.dot(&damped);
    *hessian += &damped * damped.transpose() / of_damped - &along * along.transpose() / curvature;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `(x - 2)² + (y - 1)²` with `x = 2 y - 1 + 0.25 (x² - 1)...`: a curved equation and two inequalities.
    struct Curved;

    impl Program for Curved {
        fn evaluate(&self, x: &DVector<f64>) -> Option<Evaluated> {
            Some(Evaluated {
                f: (x[0] - 2.0).powi(2) + (x[1] - 1.0).powi(2),
                gradient: DVector::from_vec(vec![2.0 * (x[0] - 2.0), 2.0 * (x[1] - 1.0)]),
                hessian: DMatrix::identity(2, 2),
                c: DVector::from_vec(vec![x[0] * x[0] + x[1] * x[1] - 1.0]),
                jacobian: DMatrix::from_row_slice(1, 2, &[2.0 * x[0], 2.0 * x[1]]),
            })
        }
    }

    #[test]
    fn finds_the_nearest_point_of_a_circle_and_respects_a_wall() {
        let start = DVector::from_vec(vec![0.3, 0.9]);
        let loose = (DMatrix::identity(2, 2), DVector::from_vec(vec![5.0, 5.0]));
        let minimum = interior_point(&Curved, &start, (&loose.0, &loose.1)).unwrap();
        // (2, 1) over its length; the tolerance of the method.
        assert!((minimum.x[0] - 2.0 / 5.0_f64.sqrt()).abs() < 1e-7 && minimum.infeasibility < 1e-8, "{minimum:?}");
        // x at most 0.6: the corner of wall and circle.
        let wall = (DMatrix::from_row_slice(1, 2, &[-1.0, 0.0]), DVector::from_vec(vec![0.6]));
        let minimum = interior_point(&Curved, &start, (&wall.0, &wall.1)).unwrap();
        assert!((minimum.x[0] - 0.6).abs() < 1e-7 && (minimum.x[1] - 0.8).abs() < 1e-7, "{minimum:?}");
    }
}

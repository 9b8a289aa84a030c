//! Bounded Levenberg-Marquardt for four parameters, the sizes known to the compiler.
//!
//! The same method as [`levenberg_marquardt`](super::levenberg_marquardt) without its heap memory: the springs and
//! dampers of a two-mass model are four, and a fit of it starts from dozens of points.

use nalgebra::{Dyn, Matrix4, OMatrix, SMatrix, U5, Vector4};

use super::stop_reason::StopReason;

/// A residual vector that depends on four parameters.
pub trait Residuals {
    /// Residuals at `theta`; `None` if the response is not finite there.
    fn residuals(&self, theta: &Vector4<f64>) -> Option<Vec<f64>>;
    /// Rows `[dr/dtheta, r]`, one for each residual.
    fn rows(&self, theta: &Vector4<f64>) -> Option<OMatrix<f64, Dyn, U5>>;
}

/// When to stop and where to stay.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Smallest value of each unknown.
    pub lower: Vector4<f64>,
    /// Largest value of each unknown.
    pub upper: Vector4<f64>,
    /// Steps after which the best point so far is the result.
    pub max_iterations: u32,
    /// Smallest relative decrease of the cost, predicted and found, that is worth going on for.
    pub cost_tolerance: f64,
    /// Largest step, in the unit of the parameters, that counts as standing still.
    pub step_tolerance: f64,
    /// Largest cosine between residuals and sensitivities that counts as orthogonal.
    pub gradient_tolerance: f64,
}

/// Where a fit ended.
#[derive(Debug, Clone)]
pub struct Minimum {
    /// The unknowns.
    pub theta: Vector4<f64>,
    /// Sum of squares.
    pub cost: f64,
    /// Upper triangle of the sensitivities there: `J'J = R'R`.
    pub r: Matrix4<f64>,
    /// Unknowns that stand on a bound beyond which the cost falls.
    pub on_bound: [bool; 4],
    /// Steps tried.
    pub iterations: u32,
    /// Evaluations of the residuals.
    pub evaluations: u64,
    /// Why the descent ended.
    pub stop: StopReason,
}

/// The sensitivities and residuals, reduced by QR: `|J d + r|² = |R d + q|² + rest`.
struct Linear {
    r: Matrix4<f64>,
    q: Vector4<f64>,
    cost: f64,
}

/// Derivatives and residuals at `theta`, reduced to a triangle; `None` where one of them is not finite.
fn linearise(problem: &impl Residuals, theta: &Vector4<f64>) -> Option<Linear> {
    let rows = problem.rows(theta)?;
    let cost = rows.column(4).norm_squared();
    // Never J'J: it would square the condition of the sensitivities.
    let triangle = rows.qr().r();
    if !(triangle.iter().all(|x| x.is_finite()) && cost.is_finite()) {
        return None;
    }
    Some(Linear {
        r: triangle.fixed_view::<4, 4>(0, 0).into_owned(),
        q: triangle.fixed_view::<4, 1>(0, 4).into_owned(),
        cost,
    })
}

/// Minimises the sum of squares from `start` (moved into the bounds).
///
/// Steps solve `min |R d + q|² + lambda |D d|²` by QR, `D` the largest column norms seen (Marquardt's scaling);
/// lambda follows Nielsen's rule. A parameter on a bound whose gradient points outwards is fixed, and no step
/// leaves the box. Local: the result depends on the start. `None` if the start has no finite response.
///
/// Madsen, Nielsen, Tingleff, *Methods for non-linear least squares problems*, 2nd ed., 2004, section 3.2.
pub fn minimise(problem: &impl Residuals, start: &Vector4<f64>, settings: &Settings) -> Option<Minimum> {
    let mut theta = clamp(start, settings);
    let mut linear = linearise(problem, &theta)?;
    let mut evaluations = 1;
    let mut scale = Vector4::zeros();
    let (mut lambda, mut growth) = (1e-3, 2.0);
    let mut iterations = 0;
    let stop = loop {
        for i in 0..4 {
            scale[i] = linear.r.column(i).norm().max(scale[i]);
        }
        let on_bound = fixed_at_bound(&theta, &linear, settings);
        if is_stationary(&linear, on_bound, settings) {
            break StopReason::GradientConverged;
        }
        if iterations >= settings.max_iterations {
            break StopReason::IterationLimit;
        }
        iterations += 1;
        let room = std::array::from_fn(|i| (settings.lower[i] - theta[i], settings.upper[i] - theta[i]));
        let Some(step) = damped_step(&linear, &scale, lambda, on_bound, &room) else {
            lambda *= growth;
            growth *= 2.0;
            continue;
        };
        let next = clamp(&(theta + step), settings);
        let step = next - theta;
        if step.amax() <= settings.step_tolerance {
            break StopReason::StepConverged;
        }
        let predicted = linear.q.norm_squared() - (linear.r * step + linear.q).norm_squared();
        evaluations += 1;
        let next_cost = problem.residuals(&next).map_or(f64::INFINITY, |r| r.iter().map(|x| x * x).sum());
        let decrease = linear.cost - next_cost;
        if decrease > 0.0 && predicted > 0.0 {
            let gain = decrease / predicted;
            let small = settings.cost_tolerance * linear.cost;
            let done = decrease <= small && predicted <= small;
            // A finite cost and no finite sensitivities: stay with the last point that has both.
            evaluations += 1;
            let Some(there) = linearise(problem, &next) else { break StopReason::StepConverged };
            theta = next;
            linear = there;
            lambda *= (1.0_f64 / 3.0).max(1.0 - (2.0 * gain - 1.0).powi(3));
            growth = 2.0;
            if done {
                break StopReason::CostConverged;
            }
        } else {
            if predicted <= settings.cost_tolerance * linear.cost {
                break StopReason::CostConverged;
            }
            lambda *= growth;
            growth *= 2.0;
        }
    };
    let on_bound = fixed_at_bound(&theta, &linear, settings);
    Some(Minimum { theta, cost: linear.cost, r: linear.r, on_bound, iterations, evaluations, stop })
}

/// The nearest point of the box.
fn clamp(theta: &Vector4<f64>, settings: &Settings) -> Vector4<f64> {
    theta.zip_zip_map(&settings.lower, &settings.upper, f64::clamp)
}

/// Parameters on a bound with the descent direction pointing outwards.
fn fixed_at_bound(theta: &Vector4<f64>, linear: &Linear, settings: &Settings) -> [bool; 4] {
    let gradient = linear.r.tr_mul(&linear.q);
    std::array::from_fn(|i| {
        (theta[i] <= settings.lower[i] && gradient[i] >= 0.0) || (theta[i] >= settings.upper[i] && gradient[i] <= 0.0)
    })
}

/// Whether the residuals are orthogonal to the sensitivity of every parameter that is not fixed at its bound.
fn is_stationary(linear: &Linear, on_bound: [bool; 4], settings: &Settings) -> bool {
    let gradient = linear.r.tr_mul(&linear.q);
    let size = linear.cost.sqrt();
    (0..4)
        .filter(|&i| !on_bound[i])
        .all(|i| gradient[i].abs() <= settings.gradient_tolerance * linear.r.column(i).norm() * size)
}

/// The damped step inside the box: a parameter that would leave it moves to the bound, and the others are solved for
/// again given that.
fn damped_step(
    linear: &Linear,
    scale: &Vector4<f64>,
    lambda: f64,
    on_bound: [bool; 4],
    room: &[(f64, f64); 4],
) -> Option<Vector4<f64>> {
    let mut fixed = on_bound.map(|fixed| fixed.then_some(0.0));
    loop {
        let mut stacked = SMatrix::<f64, 8, 4>::zeros();
        let mut right = SMatrix::<f64, 8, 1>::zeros();
        stacked.fixed_view_mut::<4, 4>(0, 0).copy_from(&linear.r);
        let mut target = -linear.q;
        for i in 0..4 {
            let free = fixed[i].is_none();
            if let Some(distance) = fixed[i] {
                target -= linear.r.column(i) * distance;
                stacked.column_mut(i).fill(0.0);
            }
            let weight = if free && scale[i] > 0.0 { scale[i] } else { 1.0 };
            stacked[(4 + i, i)] = lambda.sqrt() * weight;
        }
        right.fixed_view_mut::<4, 1>(0, 0).copy_from(&target);
        let qr = stacked.qr();
        let mut step = qr.r().solve_upper_triangular(&qr.q().tr_mul(&right))?;
        let mut leaves = false;
        for i in 0..4 {
            let (down, up) = room[i];
            match fixed[i] {
                Some(distance) => step[i] = distance,
                None if step[i] < down || step[i] > up => {
                    fixed[i] = Some(step[i].clamp(down, up));
                    leaves = true;
                }
                None => {}
            }
        }
        // At most four rounds: each fixes one more.
        if !leaves {
            return step.iter().all(|x| x.is_finite()).then_some(step);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `y = theta0 exp(theta1 t) + theta2 + theta3 t`.
    struct Curve {
        y: Vec<f64>,
    }

    fn model(theta: &Vector4<f64>, t: f64) -> f64 {
        theta[0] * (theta[1] * t).exp() + theta[2] + theta[3] * t
    }

    impl Residuals for Curve {
        fn residuals(&self, theta: &Vector4<f64>) -> Option<Vec<f64>> {
            let r = self.y.iter().enumerate().map(|(k, y)| model(theta, k as f64 * 0.1) - y);
            Some(r.collect())
        }
        fn rows(&self, theta: &Vector4<f64>) -> Option<OMatrix<f64, Dyn, U5>> {
            let mut rows = OMatrix::<f64, Dyn, U5>::zeros(self.y.len());
            for (k, y) in self.y.iter().enumerate() {
                let t = k as f64 * 0.1;
                let e = (theta[1] * t).exp();
                let row = [e, theta[0] * t * e, 1.0, t, model(theta, t) - y];
                for (j, x) in row.into_iter().enumerate() {
                    rows[(k, j)] = x;
                }
            }
            Some(rows)
        }
    }

    fn settings(upper: f64) -> Settings {
        Settings {
            lower: Vector4::repeat(-upper),
            upper: Vector4::repeat(upper),
            max_iterations: 200,
            cost_tolerance: 1e-14,
            step_tolerance: 1e-14,
            gradient_tolerance: 1e-14,
        }
    }

    #[test]
    fn finds_the_parameters_of_an_exact_curve() {
        let truth = Vector4::new(2.0, -1.5, 0.5, 0.3);
        let problem = Curve { y: (0..40).map(|k| model(&truth, f64::from(k) * 0.1)).collect() };
        let found = minimise(&problem, &Vector4::new(1.0, -0.5, 0.0, 0.0), &settings(10.0)).unwrap();
        // Rounding of the data (1e-16) times the condition of the sensitivities (below 1e3).
        assert!((found.theta - truth).amax() < 1e-12, "{:?}", found.theta);
        assert_eq!(found.on_bound, [false; 4]);
    }

    #[test]
    fn stops_on_a_bound_and_says_so() {
        let truth = Vector4::new(2.0, -1.5, 0.5, 0.3);
        let problem = Curve { y: (0..40).map(|k| model(&truth, f64::from(k) * 0.1)).collect() };
        let found = minimise(&problem, &Vector4::new(1.0, -0.5, 0.0, 0.0), &settings(1.2)).unwrap();
        assert_eq!(found.on_bound, [true, true, false, false]);
        assert_eq!((found.theta[0], found.theta[1]), (1.2, -1.2));
        assert_ne!(found.stop, StopReason::IterationLimit);
        // The other two are at their minimum: the residuals are orthogonal to their sensitivities.
        let rows = problem.rows(&found.theta).unwrap();
        for j in 2..4 {
            let cosine = rows.column(j).dot(&rows.column(4)) / (rows.column(j).norm() * rows.column(4).norm());
            // The cost is flat to 1e-14 here: its slope is known to the root of that.
            assert!(cosine.abs() < 1e-7, "{j}: {cosine}");
        }
        assert!(rows.column(4).norm() > 1e-3);
    }
}

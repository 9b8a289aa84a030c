//! The nonlinear models fitted to the compartment's displacement.

use crumple_lumped::{Model, Nonlinear1, Nonlinear2};
use crumple_signal::{Displacement, Signal};
use rayon::prelude::*;

use crate::candidate::linearised::uncertainty;
use crate::error::positive;
use crate::fit::nonlinear::momentum_starts::{Momentum, Start};
use crate::fit::nonlinear::problem::{Displacements, chain1, chain2, conditions_at_crush, units};
use crate::fit::sensors::fit::all;
use crate::record::window::Window;
use crate::{Fit, SolveError, Uncertainty};
use crumple_estimation::minimise::levenberg_marquardt::{Bounds, Response, descend};

/// What a fit of a nonlinear model is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NonlinearFitOptions {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Speed at contact, m/s: the last knot of the damper.
    pub impact_speed_m_per_s: f64,
    /// Dynamic crush, m: the last knot of the spring.
    pub crush_m: f64,
    /// Time of dynamic crush, s after contact.
    pub time_of_dynamic_crush_s: f64,
    /// Contact on the record's time axis, s.
    pub time_zero_s: f64,
    /// Start of the window, s after contact.
    pub from_s: f64,
    /// End of the window; `None`: end of the record.
    pub to_s: Option<f64>,
    /// At most so many samples are used.
    pub samples: usize,
}

/// Places of the middle knot of the spring that are tried, shares of the crush.
const SPRING_KNOTS: [f64; 9] = [0.1, 0.25, 0.4, 0.55, 0.7, 0.8, 0.87, 0.93, 0.97];
/// Places of the knots of the damper, shares of the impact speed: quadratic, since most of the motion near rest is slow.
const DAMPER_KNOTS: [f64; 9] = [0.012, 0.05, 0.11, 0.2, 0.31, 0.44, 0.6, 0.75, 0.9];
/// Starts that are refined, and those followed to the end.
const REFINED: usize = 8;
const FOLLOWED: usize = 2;

fn check(options: &NonlinearFitOptions) -> Result<(), SolveError> {
    positive("mass_kg", options.mass_kg)?;
    positive("impact_speed_m_per_s", options.impact_speed_m_per_s)?;
    positive("crush_m", options.crush_m)?;
    positive("time_of_dynamic_crush_s", options.time_of_dynamic_crush_s)?;
    Ok(())
}

/// Fits the ten parameters of the second nonlinear model.
///
/// For fixed knots the force is linear in the seven coefficients, and the momentum it takes,
/// `m (v0 - v(t)) = sum of coefficient_j times the integral of hat_j`, needs no acceleration: non-negative least squares
/// on a grid of 324 knot vectors gives starting values; the best eight go through bounded Levenberg-Marquardt on the
/// simulated displacement, the best two to the end. Deterministic. From the exact displacement of the paper's own
/// parameters all ten come back. A real record determines fewer: see the deviations and the active bounds.
///
/// Errors: masses, speed or crush that are not positive, a window outside the record, no finite response.
pub fn fit_nonlinear2(
    displacement: &Signal<Displacement>,
    options: &NonlinearFitOptions,
) -> Result<(Nonlinear2, Fit, Option<Uncertainty>), SolveError> {
    check(options)?;
    let window = Window::pick(displacement, options.time_zero_s, options.from_s, options.to_s, options.samples)?;
    let momentum = Momentum::of(&window, options);
    let springs: Vec<_> = SPRING_KNOTS.iter().map(|x1| momentum.columns(&momentum.x, &[0.0, *x1, 1.0])).collect();
    let pairs: Vec<(f64, f64)> = DAMPER_KNOTS
        .iter()
        .enumerate()
        .flat_map(|(i, v1)| DAMPER_KNOTS[i + 1..].iter().map(move |v2| (*v1, *v2)))
        .collect();
    let mut starts: Vec<Start> = pairs
        .par_iter()
        .flat_map_iter(|(v1, v2)| {
            let damper = momentum.columns(&momentum.v, &[0.0, *v1, *v2, 1.0]);
            let tried: Vec<Start> = springs
                .iter()
                .zip(SPRING_KNOTS)
                .map(|(spring, x1)| {
                    let (values, cost) = momentum.solve(spring, &damper);
                    Start { knots: vec![x1, *v1, *v2], values, cost }
                })
                .collect();
            tried
        })
        .collect();
    starts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    starts.truncate(REFINED);

    // Momentum over v0: a spring coefficient is in units of m v0/C a second, a damper one of m a second.
    let (spring, damper) = units(options);
    let to_theta = |start: &Start| -> Vec<f64> {
        let rate = options.impact_speed_m_per_s / options.crush_m;
        let v: Vec<f64> = start.values.iter().map(|x| x / rate).collect();
        vec![v[0], v[1], v[2], start.knots[0], v[3], v[4], v[5], v[6], start.knots[1], start.knots[2]]
    };
    let build = |theta: &[f64]| nonlinear2(theta, options, spring, damper);
    let problem = Displacements {
        window: &window,
        options,
        model: |theta: &[f64]| build(theta).map(Model::Nonlinear2),
        chain: chain2,
        conditions: None,
    };
    let mut bounds = Bounds { lower: vec![0.0; 10], upper: vec![1e3; 10], max_iterations: 12, cost_tolerance: 1e-4 };
    for knot in [3, 8, 9] {
        bounds.lower[knot] = 0.005;
        bounds.upper[knot] = 0.995;
    }
    let (mut found, mut evaluations) = all(&problem, starts.iter().map(to_theta).collect(), &bounds);
    found.truncate(FOLLOWED);
    bounds.max_iterations = 120;
    bounds.cost_tolerance = 1e-9;
    let (found, more) = all(&problem, found.into_iter().map(|m| m.theta).collect(), &bounds);
    evaluations += more;
    let best = found.first().ok_or(SolveError::NoFit { starts: REFINED })?;
    let model = build(&best.theta).ok_or(SolveError::NoFit { starts: REFINED })?;
    let names = [
        "k1_n_per_m",
        "k2_n_per_m",
        "k3_n_per_m",
        "x1_m",
        "c1_n_s_per_m",
        "c2_n_s_per_m",
        "c3_n_s_per_m",
        "c4_n_s_per_m",
        "v1_m_per_s",
        "v2_m_per_s",
    ];
    // The knots of the damper stand in rising order in the model.
    let mut ordered = best.clone();
    if best.theta[8] > best.theta[9] {
        for (i, j) in [(5, 6), (8, 9)] {
            ordered.theta.swap(i, j);
            ordered.on_bound.swap(i, j);
            ordered.r.swap_columns(i, j);
        }
    }
    let (x, v) = (options.crush_m, options.impact_speed_m_per_s);
    let factors = [spring, spring, spring, x, damper, damper, damper, damper, v, v];
    let mut rest = vec![0.0; problem.rows()];
    let known = problem.residuals(&best.theta, &mut rest);
    let deviations = known.then(|| uncertainty(&ordered, &rest, &names, &factors)).flatten();
    Ok((model, Fit::of_displacement(&ordered, &window, evaluations, &names, options.crush_m), deviations))
}

/// The model of scaled parameters; the knots of the damper in rising order, each with its value.
fn nonlinear2(theta: &[f64], options: &NonlinearFitOptions, spring: f64, damper: f64) -> Option<Nonlinear2> {
    let (mut first, mut second) = ((theta[8], theta[5]), (theta[9], theta[6]));
    if first.0 > second.0 {
        std::mem::swap(&mut first, &mut second);
    }
    let v0 = options.impact_speed_m_per_s;
    let model = Nonlinear2 {
        mass_kg: options.mass_kg,
        k1_n_per_m: theta[0] * spring,
        k2_n_per_m: theta[1] * spring,
        k3_n_per_m: theta[2] * spring,
        x1_m: theta[3] * options.crush_m,
        c1_n_s_per_m: theta[4] * damper,
        c2_n_s_per_m: first.1 * damper,
        c3_n_s_per_m: second.1 * damper,
        c4_n_s_per_m: theta[7] * damper,
        v1_m_per_s: first.0 * v0,
        v2_m_per_s: second.0 * v0,
        crush_m: options.crush_m,
        v0_m_per_s: v0,
    };
    model.check().is_ok().then_some(model)
}

/// Fits the first nonlinear model under the side constraints of the paper: `k1 <= k2`, `c1 >= c2 >= c3`, and at the time of
/// dynamic crush `x = C` and `v = 0`.
///
/// The inequalities by parameters that are sums of non-negative parts, the two equations by augmented Lagrangian around
/// the bounded least squares, to 1e-8 of crush and speed. Starts as in [`fit_nonlinear2`], from nine places of the knee.
/// With `constrained` false the two equations are left out.
pub fn fit_nonlinear1(
    displacement: &Signal<Displacement>,
    options: &NonlinearFitOptions,
    constrained: bool,
) -> Result<(Nonlinear1, Fit), SolveError> {
    check(options)?;
    let window = Window::pick(displacement, options.time_zero_s, options.from_s, options.to_s, options.samples)?;
    let momentum = Momentum::of(&window, options);
    let springs = momentum.columns(&momentum.x, &[0.0, 1.0]);
    let sum = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a + b).collect() };
    // k = k1 + (k2 - k1) ramp; c = c3 + (c2 - c3) [first two hats] + (c1 - c2) [first hat].
    let spring_parts = vec![sum(&springs[0], &springs[1]), springs[1].clone()];
    let mut starts: Vec<Start> = DAMPER_KNOTS
        .iter()
        .map(|knee| {
            let c = momentum.columns(&momentum.v, &[0.0, *knee, 1.0]);
            let two = sum(&c[0], &c[1]);
            let parts = vec![c[0].clone(), two.clone(), sum(&two, &c[2])];
            let (values, cost) = momentum.solve(&spring_parts, &parts);
            Start { knots: vec![*knee], values, cost }
        })
        .collect();
    starts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    starts.truncate(REFINED);
    let (spring, damper) = units(options);
    let v0 = options.impact_speed_m_per_s;
    let build = |theta: &[f64]| {
        let model = Nonlinear1 {
            mass_kg: options.mass_kg,
            k1_n_per_m: theta[0] * spring,
            k2_n_per_m: (theta[0] + theta[1]) * spring,
            c1_n_s_per_m: (theta[2] + theta[3] + theta[4]) * damper,
            c2_n_s_per_m: (theta[3] + theta[4]) * damper,
            c3_n_s_per_m: theta[4] * damper,
            v_thresh_m_per_s: theta[5] * v0,
            crush_m: options.crush_m,
            v0_m_per_s: v0,
        };
        model.check().is_ok().then_some(model)
    };
    let rate = v0 / options.crush_m;
    let points = starts.iter().map(|s| s.values.iter().map(|x| x / rate).chain([s.knots[0]]).collect()).collect();
    let mut bounds = Bounds { lower: vec![0.0; 6], upper: vec![1e3; 6], max_iterations: 30, cost_tolerance: 1e-4 };
    (bounds.lower[5], bounds.upper[5]) = (0.005, 0.995);
    let model = |theta: &[f64]| build(theta).map(Model::Nonlinear1);
    let mut problem = Displacements { window: &window, options, model, chain: chain1, conditions: None };
    let (found, mut evaluations) = all(&problem, points, &bounds);
    bounds.max_iterations = 120;
    bounds.cost_tolerance = 1e-10;
    let (mut found, more) = all(&problem, found.into_iter().take(FOLLOWED).map(|m| m.theta).collect(), &bounds);
    evaluations += more;
    if found.is_empty() {
        return Err(SolveError::NoFit { starts: REFINED });
    }
    let mut best = found.remove(0);
    if constrained {
        // Residuals are of size one times the number of samples.
        let mut weight = window.samples.len() as f64;
        let mut multipliers = [0.0; 2];
        for _ in 0..12 {
            problem.conditions = Some((weight, multipliers));
            let Some(next) = descend(&problem, &best.theta, &bounds) else { break };
            evaluations += next.evaluations;
            best = next;
            let Some(conditions) = build(&best.theta).and_then(|m| conditions_at_crush(&m, options)) else {
                break;
            };
            for j in 0..2 {
                multipliers[j] += weight * conditions[j];
            }
            if conditions.iter().all(|c| c.abs() <= 1e-9) {
                break;
            }
            weight = (weight * 4.0).min(1e8);
        }
        // The cost of the record alone.
        problem.conditions = None;
        let mut rest = vec![0.0; problem.rows()];
        if problem.residuals(&best.theta, &mut rest) {
            best.cost = rest.iter().map(|x| x * x).sum();
        }
    }
    let model = build(&best.theta).ok_or(SolveError::NoFit { starts: REFINED })?;
    // A part on its bound makes two coefficients equal.
    let names = ["k1_n_per_m", "k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m", "c3_n_s_per_m", "v_thresh_m_per_s"];
    Ok((model, Fit::of_displacement(&best, &window, evaluations, &names, options.crush_m)))
}

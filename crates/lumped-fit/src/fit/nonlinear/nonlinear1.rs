//! The first nonlinear model fitted to the compartment's displacement, under the side constraints of its paper.

use crumple_estimation::minimise::levenberg_marquardt::{Bounds, Optimum, Response, descend};
use crumple_lumped::{Model, Nonlinear1};
use crumple_signal::{Displacement, Signal};

use crate::fit::descents::all;
use crate::fit::nonlinear::momentum_starts::{DAMPER_KNOTS, FOLLOWED, Momentum, REFINED, Start};
use crate::fit::nonlinear::problem::{Displacements, conditions_at_crush, derivatives1};
use crate::fit::options::SingleMassFitOptions;
use crate::record::window::Window;
use crate::{Fit, SolveError};

/// Rounds of the augmented Lagrangian.
const ROUNDS: usize = 12;

/// Fits the first nonlinear model under the side constraints of its paper: `k1 <= k2`, `c1 >= c2 >= c3`, and at the
/// time of dynamic crush `x = C` and `v = 0`.
///
/// The coefficients are sums of parts that are not negative, which keeps their order: `k2 = k1 + d`, `c1 = c2 + e`,
/// `c2 = c3 + f`. Bounded Levenberg-Marquardt in these parts and the knot, from nine knots whose parts follow from
/// the momentum balance. The two equations are met by an augmented Lagrangian around that, to 1e-9 of crush and speed
/// where they can be met at all; see [`conditions_at_crush`](crate::conditions_at_crush) for what is left.
/// `constrained` false leaves them out, for a record that never stops.
///
/// The error in the record of the fit is that of the displacement alone. No standard deviations: at the constraints
/// they have no linear form. Single-mass paper, section 4.1. Errors: values that are not positive, a window outside
/// the record, no start with a finite response.
pub fn fit_nonlinear1(
    displacement: &Signal<Displacement>,
    options: &SingleMassFitOptions,
    constrained: bool,
) -> Result<(Nonlinear1, Fit), SolveError> {
    options.check()?;
    let window = options.window(displacement)?;
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
    let rate = options.impact_speed_m_per_s / options.crush_m;
    let points = starts.iter().map(|s| s.values.iter().map(|x| x / rate).chain([s.knots[0]]).collect()).collect();
    let problem = parts_problem(&window, options, None);
    let (ends, mut evaluations) = all(&problem, points, &bounds(30, 1e-4));
    let hopeful = ends.into_iter().take(FOLLOWED).map(|m| m.theta).collect();
    let (mut ends, more) = all(&problem, hopeful, &bounds(120, 1e-10));
    evaluations += more;
    if ends.is_empty() {
        return Err(SolveError::NoFit { starts: REFINED });
    }
    let mut best = ends.remove(0);
    if constrained {
        if let Some((end, spent, _)) = descend_to_conditions(&window, options, &best.theta, (1e-10, 1e-9)) {
            evaluations += spent;
            best = end;
        }
        // The cost of the record alone.
        let mut residuals = vec![0.0; problem.rows()];
        if problem.residuals(&best.theta, &mut residuals) {
            best.cost = residuals.iter().map(|x| x * x).sum();
        }
    }
    let model = model_of_parts(&best.theta, options).ok_or(SolveError::NoFit { starts: REFINED })?;
    // A part on its bound makes two coefficients equal.
    let names = ["k1_n_per_m", "k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m", "c3_n_s_per_m", "v_thresh_m_per_s"];
    Ok((model, Fit::of_displacement(&best, &window, evaluations, &names, options.crush_m)))
}

/// The model of six coordinates: parts of springs, parts of dampers, all over their units, and the knot over the impact
/// speed. `None` if it is not physical.
pub(crate) fn model_of_parts(theta: &[f64], options: &SingleMassFitOptions) -> Option<Nonlinear1> {
    let ((spring, damper), v0) = (options.units(), options.impact_speed_m_per_s);
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
}

/// The coordinates of a model.
pub(crate) fn parts_of_model(m: &Nonlinear1, options: &SingleMassFitOptions) -> [f64; 6] {
    let (k, c) = options.units();
    [
        m.k1_n_per_m / k,
        (m.k2_n_per_m - m.k1_n_per_m) / k,
        (m.c1_n_s_per_m - m.c2_n_s_per_m) / c,
        (m.c2_n_s_per_m - m.c3_n_s_per_m) / c,
        m.c3_n_s_per_m / c,
        m.v_thresh_m_per_s / options.impact_speed_m_per_s,
    ]
}

/// No part is negative; the knot stays inside the range of speeds.
fn bounds(max_iterations: u32, cost_tolerance: f64) -> Bounds {
    let (mut lower, mut upper) = (vec![0.0; 6], vec![1e3; 6]);
    (lower[5], upper[5]) = (0.005, 0.995);
    Bounds { lower, upper, max_iterations, cost_tolerance }
}

/// The residuals of these parts, with the conditions at dynamic crush or without.
fn parts_problem<'a>(
    window: &'a Window,
    options: &'a SingleMassFitOptions,
    conditions: Option<(f64, [f64; 2])>,
) -> Displacements<'a, impl Fn(&[f64]) -> Option<Model>> {
    let model = move |theta: &[f64]| model_of_parts(theta, options).map(Model::Nonlinear1);
    Displacements { window, options, model, derivatives: derivatives1, conditions }
}

/// Descends from `start` under the two conditions at dynamic crush, by an augmented Lagrangian, until they are met to
/// `met` of crush and speed or twelve rounds are over. The end, the evaluations spent, and whether they are met; `None`
/// without a finite response.
pub(crate) fn descend_to_conditions(
    window: &Window,
    options: &SingleMassFitOptions,
    start: &[f64],
    (cost_tolerance, met): (f64, f64),
) -> Option<(Optimum, u64, bool)> {
    // Residuals are of size one times the number of samples.
    let mut weight = window.samples.len() as f64;
    let mut multipliers = [0.0; 2];
    let (mut end, mut evaluations): (Option<Optimum>, u64) = (None, 0);
    for _ in 0..ROUNDS {
        let problem = parts_problem(window, options, Some((weight, multipliers)));
        let from = end.as_ref().map_or(start, |end| &end.theta);
        let Some(next) = descend(&problem, from, &bounds(120, cost_tolerance)) else { break };
        evaluations += next.evaluations;
        let left = model_of_parts(&next.theta, options).and_then(|model| conditions_at_crush(&model, options));
        end = Some(next);
        let Some(left) = left else { break };
        if left.iter().all(|condition| condition.abs() <= met) {
            return Some((end?, evaluations, true));
        }
        for (multiplier, condition) in multipliers.iter_mut().zip(left) {
            *multiplier += weight * condition;
        }
        weight = (weight * 4.0).min(1e8);
    }
    Some((end?, evaluations, false))
}

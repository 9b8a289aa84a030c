//! The first nonlinear model fitted to the compartment's displacement, under the side constraints of its paper.

use crumple_estimation::minimise::levenberg_marquardt::{Bounds, Response, descend};
use crumple_lumped::{Model, Nonlinear1};
use crumple_signal::{Displacement, Signal};

use crate::fit::descents::all;
use crate::fit::nonlinear::momentum_starts::{DAMPER_KNOTS, FOLLOWED, Momentum, REFINED, Start};
use crate::fit::nonlinear::problem::{Displacements, conditions_at_crush, derivatives1};
use crate::fit::options::SingleMassFitOptions;
use crate::{Fit, SolveError};

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
    let (spring, damper) = options.units();
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
    let mut problem = Displacements { window: &window, options, model, derivatives: derivatives1, conditions: None };
    let (ends, mut evaluations) = all(&problem, points, &bounds);
    bounds.max_iterations = 120;
    bounds.cost_tolerance = 1e-10;
    let (mut ends, more) = all(&problem, ends.into_iter().take(FOLLOWED).map(|m| m.theta).collect(), &bounds);
    evaluations += more;
    if ends.is_empty() {
        return Err(SolveError::NoFit { starts: REFINED });
    }
    let mut best = ends.remove(0);
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
        let mut residuals = vec![0.0; problem.rows()];
        if problem.residuals(&best.theta, &mut residuals) {
            best.cost = residuals.iter().map(|x| x * x).sum();
        }
    }
    let model = build(&best.theta).ok_or(SolveError::NoFit { starts: REFINED })?;
    // A part on its bound makes two coefficients equal.
    let names = ["k1_n_per_m", "k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m", "c3_n_s_per_m", "v_thresh_m_per_s"];
    Ok((model, Fit::of_displacement(&best, &window, evaluations, &names, options.crush_m)))
}

//! The first nonlinear model fitted to the compartment's displacement, under the side constraints of its paper.

use crumple_lumped::{Model, Nonlinear1};
use crumple_numerics::estimation::minimise::levenberg_marquardt::{Optimum, Response, descend};
use crumple_signal::{Displacement, Signal};

use crate::fit::at_crush::AtCrush;
use crate::fit::descents::bounds;
use crate::fit::multistart::best_of_starts;
use crate::fit::nonlinear::coordinates::{coordinates, record_of_fit};
use crate::fit::nonlinear::momentum_starts::{DAMPER_KNOTS, FOLLOWED, Momentum, REFINED, Start};
use crate::fit::options::SingleMassFitOptions;
use crate::fit::problem::Problem;
use crate::free::coordinates::{Coordinates, Map};
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
    let observed = options.observed(displacement)?;
    let momentum = Momentum::of(&observed.waves[0], options);
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
    // Of the dampers the smallest first, on which the others stand.
    let point = |s: &Start| [0, 1, 4, 3, 2].map(|i| s.values[i] / rate).into_iter().chain([s.knots[0]]).collect();
    let coordinates = parts(options);
    let problem = Problem { unit: options.crush_m, ..Problem::new(&coordinates, &observed, 0.0) };
    let points = starts.iter().map(point).collect();
    let [sorting, to_the_end] = [(30, 1e-4), (120, 1e-10)].map(|(steps, worth)| bounds(&coordinates, steps, worth));
    let (best, mut evaluations) = best_of_starts(&problem, points, [&sorting, &to_the_end], FOLLOWED);
    let mut best = best.ok_or(SolveError::NoFit { starts: REFINED })?;
    if constrained {
        if let Some((end, spent, _)) = descend_to_conditions(&problem, options, &best.theta, (1e-10, 1e-9)) {
            evaluations += spent;
            best = end;
        }
        // The cost of the record alone.
        let mut residuals = vec![0.0; problem.rows()];
        if problem.residuals(&best.theta, &mut residuals) {
            best.cost = residuals.iter().map(|x| x * x).sum();
        }
    }
    // A part on its bound makes two coefficients equal.
    let fit = record_of_fit(&coordinates, &observed, &best, evaluations, options);
    match coordinates.model(&best.theta) {
        Some(Model::Nonlinear1(model)) => Ok((model, fit)),
        _ => Err(SolveError::NoFit { starts: REFINED }),
    }
}

/// Springs and dampers as sums of parts that are not negative, over their units, and the knot over the impact speed.
pub(crate) fn parts(options: &SingleMassFitOptions) -> Coordinates<Model> {
    let ((k, c), v0) = (options.units(), options.impact_speed_m_per_s);
    let template = Model::Nonlinear1(Nonlinear1 {
        mass_kg: options.mass_kg,
        k1_n_per_m: k,
        k2_n_per_m: k,
        c1_n_s_per_m: c,
        c2_n_s_per_m: c,
        c3_n_s_per_m: c,
        v_thresh_m_per_s: 0.5 * v0,
        crush_m: options.crush_m,
        v0_m_per_s: v0,
    });
    // k1, k2 - k1, c3, c2 - c3, c1 - c2 and the knot.
    let springs = [(1, Map::Share(k)), (2, Map::Above(1, k))];
    let dampers = [(5, Map::Share(c)), (4, Map::Above(5, c)), (3, Map::Above(4, c)), (6, Map::Share(v0))];
    coordinates(template, &[&springs[..], &dampers].concat())
}

/// Descends from `start` under the two conditions at dynamic crush, by an augmented Lagrangian, until they are met to
/// `met` of crush and speed or twelve rounds are over. The end, the evaluations spent, and whether they are met; `None`
/// without a finite response.
pub(crate) fn descend_to_conditions(
    problem: &Problem<'_, Model>,
    options: &SingleMassFitOptions,
    start: &[f64],
    (cost_tolerance, met): (f64, f64),
) -> Option<(Optimum, u64, bool)> {
    // Residuals are of size one times the number of samples.
    let mut at_crush = AtCrush::new(options);
    at_crush.weight = problem.observed.rows() as f64;
    let bounds = bounds(problem.coordinates, 120, cost_tolerance);
    let (mut end, mut evaluations): (Option<Optimum>, u64) = (None, 0);
    for _ in 0..ROUNDS {
        let problem = Problem { at_crush: Some(at_crush), ..problem.clone() };
        let from = end.as_ref().map_or(start, |end| &end.theta);
        let Some(next) = descend(&problem, from, &bounds) else { break };
        evaluations += next.evaluations;
        let structure = problem.coordinates.structure(&next.theta);
        let left = structure.and_then(|structure| at_crush.conditions(&structure, &[]));
        end = Some(next);
        let Some((left, _)) = left else { break };
        if left.iter().all(|condition| condition.abs() <= met) {
            return Some((end?, evaluations, true));
        }
        for (multiplier, condition) in at_crush.multipliers.iter_mut().zip(left) {
            *multiplier += at_crush.weight * condition;
        }
        at_crush.weight = (at_crush.weight * 4.0).min(1e8);
    }
    Some((end?, evaluations, false))
}

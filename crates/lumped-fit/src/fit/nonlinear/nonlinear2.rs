//! The search for the second nonlinear model in the compartment's displacement.

use crumple_estimation::minimise::levenberg_marquardt::Bounds;
use crumple_lumped::{Model, Nonlinear2};
use crumple_signal::{Displacement, Signal};
use rayon::prelude::*;

use crate::fit::descents::all;
use crate::fit::nonlinear::momentum_starts::{DAMPER_KNOTS, FOLLOWED, Momentum, REFINED, Start};
use crate::fit::nonlinear::problem::{Displacements, derivatives2};
use crate::fit::options::SingleMassFitOptions;
use crate::{Fit, SolveError};

/// Places of the middle knot of the spring that are tried, shares of the crush.
const SPRING_KNOTS: [f64; 9] = [0.1, 0.25, 0.4, 0.55, 0.7, 0.8, 0.87, 0.93, 0.97];

/// Searches for the ten parameters of the second nonlinear model on the motion itself.
///
/// For fixed knots the force is linear in the seven coefficients, and the momentum it takes,
/// `m (v0 - v(t)) = sum of coefficient_j times the integral of hat_j`, needs no acceleration: non-negative least
/// squares on a grid of 324 knot vectors gives starting values; the best eight go through bounded Levenberg-Marquardt
/// on the simulated displacement, the best two to the end. Deterministic. From the exact displacement of the paper's
/// own parameters all ten come back. A real record determines fewer.
///
/// Errors: masses, speed or crush that are not positive, a window outside the record, no finite response.
pub fn search_nonlinear2(
    displacement: &Signal<Displacement>,
    options: &SingleMassFitOptions,
) -> Result<(Nonlinear2, Fit), SolveError> {
    options.check()?;
    let window = options.window(displacement)?;
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
    let (spring, damper) = options.units();
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
        derivatives: derivatives2,
        conditions: None,
    };
    let mut bounds = Bounds { lower: vec![0.0; 10], upper: vec![1e3; 10], max_iterations: 12, cost_tolerance: 1e-4 };
    for knot in [3, 8, 9] {
        bounds.lower[knot] = 0.005;
        bounds.upper[knot] = 0.995;
    }
    let (mut ends, mut evaluations) = all(&problem, starts.iter().map(to_theta).collect(), &bounds);
    ends.truncate(FOLLOWED);
    bounds.max_iterations = 120;
    bounds.cost_tolerance = 1e-9;
    let (ends, more) = all(&problem, ends.into_iter().map(|m| m.theta).collect(), &bounds);
    evaluations += more;
    let best = ends.first().ok_or(SolveError::NoFit { starts: REFINED })?;
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
        }
    }
    Ok((model, Fit::of_displacement(&ordered, &window, evaluations, &names, options.crush_m)))
}

/// The model at a point of the search; the knots of the damper in rising order, each with its value. `None` if it is
/// not physical.
fn nonlinear2(theta: &[f64], options: &SingleMassFitOptions, spring: f64, damper: f64) -> Option<Nonlinear2> {
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

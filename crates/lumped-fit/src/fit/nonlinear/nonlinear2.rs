//! The search for the second nonlinear model in the compartment's displacement.

use crumple_lumped::{Model, Nonlinear2};
use crumple_numerics::estimation::minimise::levenberg_marquardt::Bounds;
use crumple_signal::{Displacement, Signal};
use rayon::prelude::*;

use crate::fit::descents::bounds;
use crate::fit::multistart::best_of_starts;
use crate::fit::nonlinear::coordinates::{coordinates, record_of_fit};
use crate::fit::nonlinear::momentum_starts::{DAMPER_KNOTS, FOLLOWED, Momentum, REFINED, Start};
use crate::fit::options::SingleMassFitOptions;
use crate::fit::problem::{Problem, SLOW};
use crate::free::coordinates::{Coordinates, Map};
use crate::{Fit, SolveError};

/// Places of the middle knot of the spring that are tried, shares of the crush.
const SPRING_KNOTS: [f64; 9] = [0.1, 0.25, 0.4, 0.55, 0.7, 0.8, 0.87, 0.93, 0.97];

/// Steps that sort the starts into hopeful and hopeless.
const SORTING_STEPS: u32 = 10;

/// Searches for the ten parameters of the second nonlinear model on the motion itself.
///
/// For fixed knots the force is linear in the seven coefficients, and the momentum it takes,
/// `m (v0 - v(t)) = sum of coefficient_j times the integral of hat_j`, needs no acceleration: non-negative least
/// squares on a grid of 324 knot vectors gives starting values; the best eight go through bounded Levenberg-Marquardt
/// on a part of the samples of the simulated displacement, the best two to the end, the better of them then on all
/// samples. Deterministic. From the exact displacement of the paper's own parameters all ten come back. A real record
/// determines fewer.
///
/// Errors: masses, speed or crush that are not positive, a window outside the record, no finite response.
pub fn search_nonlinear2(
    displacement: &Signal<Displacement>,
    options: &SingleMassFitOptions,
) -> Result<(Nonlinear2, Fit), SolveError> {
    options.check()?;
    let observed = options.observed(displacement)?;
    let momentum = Momentum::of(&observed.waves[0], options);
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
    let to_theta = |start: &Start| -> Vec<f64> {
        let rate = options.impact_speed_m_per_s / options.crush_m;
        let v: Vec<f64> = start.values.iter().map(|x| x / rate).collect();
        vec![v[0], v[1], v[2], start.knots[0], v[3], v[4], v[5], v[6], start.knots[1], start.knots[2]]
    };
    let coordinates = shares(options);
    let problem = Problem { unit: options.crush_m, ..Problem::new(&coordinates, &observed, 0.0) };
    let points = starts.iter().map(to_theta).collect();
    let sorting = bounds(&coordinates, SORTING_STEPS, 1e-4);
    let to_the_end = Bounds { slow: SLOW, ..bounds(&coordinates, 60, 1e-9) };
    let (best, evaluations) = best_of_starts(&problem, points, [&sorting, &to_the_end], FOLLOWED);
    let best = best.ok_or(SolveError::NoFit { starts: REFINED })?;
    // The knots of the damper stand in rising order in the model.
    let mut ordered = best.clone();
    if best.theta[8] > best.theta[9] {
        for (i, j) in [(5, 6), (8, 9)] {
            ordered.theta.swap(i, j);
            ordered.on_bound.swap(i, j);
        }
    }
    let fit = record_of_fit(&coordinates, &observed, &ordered, evaluations, options);
    match coordinates.model(&best.theta) {
        Some(Model::Nonlinear2(model)) => Ok((model, fit)),
        _ => Err(SolveError::NoFit { starts: REFINED }),
    }
}

/// Springs and dampers over their units, knots over the crush and the impact speed; those of the damper in either
/// order.
fn shares(options: &SingleMassFitOptions) -> Coordinates<Model> {
    let ((k, c), v0) = (options.units(), options.impact_speed_m_per_s);
    let template = Model::Nonlinear2(Nonlinear2 {
        mass_kg: options.mass_kg,
        k1_n_per_m: k,
        k2_n_per_m: k,
        k3_n_per_m: k,
        x1_m: 0.5 * options.crush_m,
        c1_n_s_per_m: c,
        c2_n_s_per_m: c,
        c3_n_s_per_m: c,
        c4_n_s_per_m: c,
        v1_m_per_s: 0.3 * v0,
        v2_m_per_s: 0.6 * v0,
        crush_m: options.crush_m,
        v0_m_per_s: v0,
    });
    let units = [k, k, k, options.crush_m, c, c, c, c, v0, v0];
    let free: Vec<(usize, Map)> = (1..).zip(units.map(Map::Share)).collect();
    let mut coordinates = coordinates(template, &free);
    coordinates.either_order = Some([[9, 6], [10, 7]]);
    coordinates
}

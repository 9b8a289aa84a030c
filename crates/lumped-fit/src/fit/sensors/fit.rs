//! Any model fitted to any sensors: search, descent, noise levels.

use crate::fit::descents::{SCREENING_ITERATIONS, SEARCH_SAMPLES, all, bounds, distinct};
use crumple_linalg::jacobi_svd;

use crate::fit::halton_starts::start_in;
use crate::fit::sensors::problem::{SensorProblem, SensorWindow};
use crate::free::parameterisation::Parameterisation;
use crumple_estimation::minimise::l_shade::{LShadeOptions, LShadeStop, l_shade};
use crumple_estimation::minimise::levenberg_marquardt::{Optimum, Response};

/// Starts that are followed to convergence after that.
const FOLLOWED: usize = 4;
/// Steps along the weakest direction, in the coordinates, from which a descent starts once more.
const HOPS: [f64; 6] = [-0.6, 0.6, -0.2, 0.2, -0.05, 0.05];
/// Rounds of such steps.
const ROUNDS: usize = 4;
/// Rounds of finding noise levels and minimum in turn.
const WEIGHINGS: usize = 12;
/// Least noise level of a sensor, as a share of the root mean square of its record.
const LEAST_NOISE: f64 = 1e-6;

/// How minima are searched for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Search {
    /// Descents from so many evenly spread points and from points given.
    Starts(usize, Vec<Vec<f64>>),
    /// Population search, then a descent.
    LShade(LShadeOptions),
}

/// Minima of a fit and what they were found with.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    /// Distinct minima, best first.
    pub minima: Vec<Optimum>,
    /// The sensors with the noise levels they ended with.
    pub sensors: Vec<SensorWindow>,
    /// Simulations of the model by all descents and searches.
    pub evaluations: u64,
    /// Notes of the search.
    pub remarks: Vec<String>,
}

/// Fits a model to sensors; `weigh[i]` says whether the noise level of sensor i is found from its residuals.
///
/// Minimises `sum_i sum_k ((model - record)/s_i)²`, `s_i` the noise level of sensor i, in its unit. With several
/// sensors whose levels are not known the fit and the levels (root mean square residual of each sensor, at least 1e-6
/// of its record) are found in turn until no level changes by 0.1 %: at its end that is the maximum of the likelihood
/// of independent normal noise. Descents are bounded Levenberg-Marquardt on analytic sensitivities, first on a
/// thinned window.
///
/// Deterministic for any number of threads. A global minimum is likely, not proven. `None` without any finite
/// response.
pub(crate) fn fit_sensors(
    coordinates: &impl Parameterisation,
    impact_speed_m_per_s: f64,
    mut sensors: Vec<SensorWindow>,
    weigh: &[bool],
    search: &Search,
) -> Option<Fitted> {
    let mut remarks = Vec::new();
    let thin: Vec<SensorWindow> = sensors
        .iter()
        .map(|sensor| SensorWindow { window: sensor.window.thinned(SEARCH_SAMPLES), ..sensor.clone() })
        .collect();
    let coarse = SensorProblem { coordinates, impact_speed_m_per_s, sensors: &thin };
    let (ends, mut evaluations) = match search {
        Search::Starts(count, given) => multi_start(&coarse, *count, given),
        Search::LShade(options) => global(&coarse, options, &mut remarks),
    };
    let settings = bounds(coordinates, 200, 1e-15);
    let follow = |sensors: &[SensorWindow], points: Vec<Vec<f64>>| {
        let fine = SensorProblem { coordinates, impact_speed_m_per_s, sensors };
        all(&fine, points, &settings)
    };
    let (ends, spent) = follow(&sensors, ends.into_iter().map(|m| m.theta).collect());
    evaluations += spent;
    let mut minima = distinct(ends);
    let wanted = weigh.iter().filter(|w| **w).count();
    for _ in 0..if sensors.len() > 1 && wanted > 0 { WEIGHINGS } else { 0 } {
        let fine = SensorProblem { coordinates, impact_speed_m_per_s, sensors: &sensors };
        let rmse = fine.rmse(&minima.first()?.theta)?;
        let mut moved = 0.0_f64;
        for ((sensor, rmse), weigh) in sensors.iter_mut().zip(rmse).zip(weigh) {
            if *weigh {
                let noise = rmse.max(LEAST_NOISE * sensor.size()).max(f64::MIN_POSITIVE);
                moved = moved.max((noise / sensor.noise).ln().abs());
                sensor.noise = noise;
            }
        }
        let (ends, spent) = follow(&sensors, minima.iter().map(|m| m.theta.clone()).collect());
        evaluations += spent;
        minima = distinct(ends);
        if moved < 1e-3 {
            break;
        }
    }
    (!minima.is_empty()).then_some(Fitted { minima, sensors, evaluations, remarks })
}

/// Short descents from given points and from Halton points in the box of the starts; the best few to convergence;
/// then hops.
fn multi_start(
    problem: &SensorProblem<'_, impl Parameterisation>,
    count: usize,
    given: &[Vec<f64>],
) -> (Vec<Optimum>, u64) {
    let coordinates = problem.coordinates;
    let axes = coordinates.axes();
    let lower: Vec<f64> = axes.iter().map(|axis| axis.box_lower).collect();
    let upper: Vec<f64> = axes.iter().map(|axis| axis.box_upper).collect();
    let points = given.iter().cloned().chain((0..count).map(|k| start_in(k, &lower, &upper))).collect();
    let (screened, mut evaluations) = all(problem, points, &bounds(coordinates, SCREENING_ITERATIONS, 1e-6));
    let hopeful: Vec<_> = distinct(screened).into_iter().take(FOLLOWED).map(|m| m.theta).collect();
    let settings = bounds(coordinates, 200, 1e-15);
    let (ends, spent) = all(problem, hopeful, &settings);
    evaluations += spent;
    let (minima, spent) = hop(problem, distinct(ends));
    (minima, evaluations + spent)
}

/// Leaves the best minimum along its weakest direction, on whose far side other minima lie, as long as that lowers
/// the cost by 0.1 %.
fn hop(problem: &SensorProblem<'_, impl Parameterisation>, mut minima: Vec<Optimum>) -> (Vec<Optimum>, u64) {
    let settings = bounds(problem.coordinates, 200, 1e-15);
    let mut evaluations = 0;
    for _ in 0..ROUNDS {
        let Some(best) = minima.first() else { break };
        let before = best.cost;
        // Rounding of the response.
        if before <= 1e-26 * problem.rows() as f64 {
            break;
        }
        let Some(weak) = weakest_direction(best) else { break };
        let from = |hop: &f64| best.theta.iter().zip(&weak).map(|(x, w)| x + hop * w).collect();
        let (more, spent) = all(problem, HOPS.iter().map(from).collect(), &settings);
        evaluations += spent;
        minima.extend(more);
        minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        minima = distinct(minima);
        if minima[0].cost > 0.999 * before {
            break;
        }
    }
    (minima, evaluations)
}

/// The unit vector in the coordinates that changes the residuals least, among those not fixed at a bound.
fn weakest_direction(optimum: &Optimum) -> Option<Vec<f64>> {
    let free: Vec<usize> = (0..optimum.theta.len()).filter(|&i| !optimum.on_bound[i]).collect();
    if free.is_empty() {
        return None;
    }
    let columns = optimum.r.select_columns(&free);
    let svd = jacobi_svd(&columns)?;
    let mut direction = vec![0.0; optimum.theta.len()];
    for (k, &i) in free.iter().enumerate() {
        direction[i] = svd.right[(k, free.len() - 1)];
    }
    Some(direction)
}

/// L-SHADE over the box of the starts, half as wide again on each side within the bounds, then a descent from its
/// best point and hops. The cost of the search is the sum of squared residuals.
fn global(
    problem: &SensorProblem<'_, impl Parameterisation>,
    options: &LShadeOptions,
    remarks: &mut Vec<String>,
) -> (Vec<Optimum>, u64) {
    let axes = problem.coordinates.axes();
    // The box of the starts, wider by its half on each side where the bounds allow it.
    let edge = |x: f64, other: f64| x + 0.5 * (x - other);
    let lower: Vec<f64> = axes.iter().map(|c| edge(c.box_lower, c.box_upper).max(c.lower)).collect();
    let upper: Vec<f64> = axes.iter().map(|c| edge(c.box_upper, c.box_lower).min(c.upper)).collect();
    let theta =
        |unit: &[f64]| -> Vec<f64> { (0..unit.len()).map(|i| lower[i] + unit[i] * (upper[i] - lower[i])).collect() };
    let rows = problem.rows();
    let population = l_shade(axes.len(), options, |unit| {
        let mut residuals = vec![0.0; rows];
        if problem.residuals(&theta(unit), &mut residuals) {
            residuals.iter().map(|r| r * r).sum()
        } else {
            f64::INFINITY
        }
    });
    let (minima, descent) = all(problem, vec![theta(&population.point)], &bounds(problem.coordinates, 200, 1e-15));
    let (minima, hops) = hop(problem, minima);
    let spent = descent + hops;
    let level = |cost: f64| (cost / rows as f64).sqrt();
    remarks.push(format!(
        "L-SHADE in the unit box of {} logarithms: {} evaluations, seed {}, {}; the descent from its best point took \
         the weighted error from {:.3e} to {:.3e} in {} more",
        axes.len(),
        population.evaluations,
        options.seed,
        match population.stop {
            LShadeStop::Evaluations => "all of those allowed",
            LShadeStop::Converged => "ended since all members were alike",
        },
        level(population.cost),
        minima.first().map_or(f64::INFINITY, |m| level(m.cost)),
        spent
    ));
    (minima, population.evaluations + spent)
}

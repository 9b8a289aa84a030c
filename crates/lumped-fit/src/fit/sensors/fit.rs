//! Any model fitted to any sensors: search, descent, weights.

use crate::fit::descents::{all, bounds, distinct};
use crumple_linalg::jacobi_svd;

use crate::fit::halton_starts::start_in;
use crate::fit::sensors::problem::{SensorProblem, SensorWindow};
use crate::free::parameterisation::Parameterisation;
use crumple_estimation::minimise::l_shade::{LShadeOptions, LShadeStop, l_shade};
use crumple_estimation::minimise::levenberg_marquardt::{Optimum, Response};

/// Samples of a sensor that searches run on.
const SEARCH_SAMPLES: usize = 64;
/// Iterations that sort starts, and how many are followed.
const SCREENING_ITERATIONS: u32 = 24;
const FOLLOWED: usize = 4;
/// Steps along the weakest direction that a minimum is left by.
const HOPS: [f64; 6] = [-0.6, 0.6, -0.2, 0.2, -0.05, 0.05];
const ROUNDS: usize = 4;
/// Rounds of weighing the sensors, and the least noise as a share of the record.
const WEIGHINGS: usize = 12;
const LEAST_NOISE: f64 = 1e-6;

/// How minima are looked for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Search {
    /// Descents from so many evenly spread points and from points given.
    Starts(usize, Vec<Vec<f64>>),
    /// Population search, then a descent.
    LShade(LShadeOptions),
}

/// What a fit found.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    /// Distinct minima, best first.
    pub minima: Vec<Optimum>,
    /// The sensors with the noise levels they ended with.
    pub sensors: Vec<SensorWindow>,
    pub evaluations: u64,
    /// What the search has to say.
    pub remarks: Vec<String>,
}

/// Fits a family to sensors; `weigh[i]` says whether the noise level of sensor i is to be found from its residuals.
///
/// Descents are bounded Levenberg-Marquardt on analytic sensitivities. With several sensors whose noise is not known
/// the fit and the noise levels (root mean square residual of each sensor, at least 1e-6 of its record) are found in
/// turn, which is the maximum of the likelihood. Deterministic. A global minimum is likely, not proven.
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

/// Leaves the best minimum along the direction the residuals know least, beyond which other minima lie, as long as that
/// finds something better.
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

/// The unit vector that changes the residuals least, among parameters not held on a bound.
fn weakest_direction(of: &Optimum) -> Option<Vec<f64>> {
    let free: Vec<usize> = (0..of.theta.len()).filter(|&i| !of.on_bound[i]).collect();
    if free.is_empty() {
        return None;
    }
    let columns = of.r.select_columns(&free);
    let svd = jacobi_svd(&columns)?;
    let mut direction = vec![0.0; of.theta.len()];
    for (k, &i) in free.iter().enumerate() {
        direction[i] = svd.right[(k, free.len() - 1)];
    }
    Some(direction)
}

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
         the \
         weighted error from {:.3e} to {:.3e} in {} more",
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

//! Any model fitted to any sensors: search, descent, noise levels.

use crate::fit::descents::{SEARCH_SAMPLES, all, bounds, distinct};
use crate::fit::halton_starts::start;
use crate::fit::multistart::MultiStart;
use crate::fit::sensors::problem::{SensorProblem, SensorWindow};
use crate::free::parameterisation::Parameterisation;
use crumple_estimation::minimise::StopReason;
use crumple_estimation::minimise::l_shade::{LShadeOptions, l_shade};
use crumple_estimation::minimise::levenberg_marquardt::{Bounds, Optimum, Response};

/// Residual, in noise levels, below which a minimum is the exact model: rounding of the response.
const EXACT: f64 = 1e-13;
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
    let axes = problem.coordinates.axes();
    let lower: Vec<f64> = axes.iter().map(|axis| axis.box_lower).collect();
    let upper: Vec<f64> = axes.iter().map(|axis| axis.box_upper).collect();
    let points = given.iter().cloned().chain((0..count).map(|k| start(k, &lower, &upper))).collect();
    searched(problem, &bounds(problem.coordinates, 200, 1e-15)).search(points)
}

/// The search for the minima of this problem: minima are told apart by their coordinates.
fn searched<'a, P: Response>(problem: &'a P, bounds: &'a Bounds) -> MultiStart<'a, P, impl Fn(&[f64]) -> Vec<f64>> {
    MultiStart { problem, bounds, exact: EXACT * EXACT * problem.rows() as f64, place: <[f64]>::to_vec }
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
    let settings = bounds(problem.coordinates, 200, 1e-15);
    let (minima, descent) = all(problem, vec![theta(&population.point)], &settings);
    let (minima, hops) = searched(problem, &settings).hop(minima);
    let spent = descent + hops;
    let level = |cost: f64| (cost / rows as f64).sqrt();
    remarks.push(format!(
        "L-SHADE in the unit box of {} logarithms: {} evaluations, seed {}, {}; the descent from its best point took \
         the weighted error from {:.3e} to {:.3e} in {} more",
        axes.len(),
        population.evaluations,
        options.seed,
        match population.stop {
            StopReason::IterationLimit => "all of those allowed",
            _ => "ended since all members were alike",
        },
        level(population.cost),
        minima.first().map_or(f64::INFINITY, |m| level(m.cost)),
        spent
    ));
    (minima, population.evaluations + spent)
}

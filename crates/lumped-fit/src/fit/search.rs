//! The search for the minima of a fit: from many starts on the motion itself, or by L-SHADE.
//!
//! What it finds are starts of the fit [as measured](crate::fit::as_measured): the motion is quick to compare, since
//! it is exact at any spacing of the samples.

use crumple_numerics::estimation::minimise::StopReason;
use crumple_numerics::estimation::minimise::l_shade::{LShadeOptions, l_shade};
use crumple_numerics::estimation::minimise::levenberg_marquardt::{Optimum, Response};

use crate::fit::descents::{SCREENING_SAMPLES, SEARCH_SAMPLES, all, distinct};
use crate::fit::halton_starts::start;
use crate::fit::multistart::{bounds_of_search, hop, multistart};
use crate::fit::problem::Problem;
use crate::free::coordinates::{Axis, Coordinates};
use crate::free::parametric::Parametric;
use crate::record::observation::{Observation, ObservedWave};

/// Rounds of finding noise levels and minimum in turn, and the change of a weight that is worth another.
const WEIGHINGS: usize = 12;
const WORTH_ANOTHER: f64 = 1e-3;

/// How minima are searched for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Search {
    /// Descents from so many evenly spread points and from points given.
    Starts(usize, Vec<Vec<f64>>),
    /// Population search, then a descent.
    LShade(LShadeOptions),
}

/// Minima of a search and what they were found with.
#[derive(Debug, Clone)]
pub(crate) struct Searched {
    /// Distinct minima, best first.
    pub minima: Vec<Optimum>,
    /// The waves with the weights they ended with, to be compared with the motion itself.
    pub observed: Observation,
    /// Simulations of the model by all descents and searches.
    pub evaluations: u64,
    /// Notes of the search.
    pub remarks: Vec<String>,
}

/// Searches for the minima of the misfit of the motion itself.
///
/// Minimises `sum_i sum_k (w_i (model - record))²`, `w_i` the weight of wave i. The weights are those of the noise
/// levels: stated, or the root mean square residual of each wave, found in turn with the minimum until no weight
/// changes by 0.1 %: at its end that is the maximum of the likelihood of independent normal noise. Descents are bounded
/// Levenberg-Marquardt on analytic sensitivities, first on thinned windows, then on all samples.
///
/// Deterministic for any number of threads. A global minimum is likely, not proven. `None` without any finite
/// response.
pub(crate) fn search(
    coordinates: &Coordinates<impl Parametric>,
    observed: &Observation,
    how: &Search,
) -> Option<Searched> {
    let mut remarks = Vec::new();
    let mut observed = observed.clone().exact();
    let sizes: Vec<f64> = observed.waves.iter().map(ObservedWave::size).collect();
    observed.weigh(&sizes, 0.0);
    let [thinnest, thin] = [SCREENING_SAMPLES, SEARCH_SAMPLES].map(|limit| observed.clone().thinned(limit));
    let [coarse, problem] = [&thinnest, &thin].map(|observed| Problem::new(coordinates, observed, 0.0));
    let (ends, mut evaluations) = match how {
        Search::Starts(count, given) => multi_start(&coarse, &problem, *count, given),
        Search::LShade(options) => global(&problem, options, &mut remarks),
    };
    let settings = bounds_of_search(coordinates);
    let mut follow = |observed: &Observation, ends: Vec<Optimum>| {
        let points = ends.into_iter().map(|m| m.theta).collect();
        let (ends, spent) = all(&Problem::new(coordinates, observed, 0.0), points, &settings);
        evaluations += spent;
        distinct(coordinates, ends)
    };
    let mut minima = follow(&observed, ends);
    for _ in 0..if observed.waves.len() > 1 { WEIGHINGS } else { 0 } {
        let rmse = Problem::new(coordinates, &observed, 0.0).rmse(&minima.first()?.theta)?;
        let moved = observed.weigh(&rmse, WORTH_ANOTHER);
        minima = follow(&observed, minima);
        if !moved {
            break;
        }
    }
    (!minima.is_empty()).then_some(Searched { minima, observed, evaluations, remarks })
}

/// Descents from given points and from Halton points in the box of the starts.
fn multi_start<M: Parametric>(
    coarse: &Problem<'_, M>,
    problem: &Problem<'_, M>,
    count: usize,
    given: &[Vec<f64>],
) -> (Vec<Optimum>, u64) {
    let axes = problem.coordinates.free.iter().map(|number| number.axis);
    let (lower, upper): (Vec<f64>, Vec<f64>) = axes.map(|axis| (axis.box_lower, axis.box_upper)).unzip();
    let points = given.iter().cloned().chain((0..count).map(|k| start(k, &lower, &upper))).collect();
    multistart(coarse, problem, points)
}

/// L-SHADE over the box of the starts, half as wide again on each side within the bounds, then a descent from its
/// best point and hops. The cost of the search is the sum of squared residuals.
fn global(
    problem: &Problem<'_, impl Parametric>,
    options: &LShadeOptions,
    remarks: &mut Vec<String>,
) -> (Vec<Optimum>, u64) {
    let axes: Vec<Axis> = problem.coordinates.free.iter().map(|number| number.axis).collect();
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
    let (minima, descent) = all(problem, vec![theta(&population.point)], &bounds_of_search(problem.coordinates));
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
            StopReason::IterationLimit => "all of those allowed",
            _ => "ended since all members were alike",
        },
        level(population.cost),
        minima.first().map_or(f64::INFINITY, |m| level(m.cost)),
        spent
    ));
    (minima, population.evaluations + spent)
}

//! The search for the minima of a fit: starts spread over a box, descents from them, restarts along the weakest
//! direction, or L-SHADE.
//!
//! What it finds are starts of the fit [as measured](crate::fit::as_measured): the motion is quick to compare, since it
//! is exact at any spacing of the samples.

use crumple_numerics::estimation::minimise::StopReason;
use crumple_numerics::estimation::minimise::l_shade::{LShadeOptions, l_shade};
use crumple_numerics::estimation::minimise::levenberg_marquardt::{Bounds, Optimum, Response, descend};
use crumple_numerics::linalg::jacobi_svd;
use rayon::prelude::*;

use crate::coordinates::Coordinates;
use crate::fit::problem::Problem;
use crate::record::observation::{Observation, ObservedWave};

/// Start `index` of a search: a Halton point in the box `lower..upper`.
///
/// The same for every run, and evenly spread for any number of starts: the discrepancy of `n` points in `d` coordinates
/// is `O((ln n)^d/n)`. Bases are the first 24 primes, repeated beyond; points in bases above 20 or so are correlated
/// until many are drawn. Halton, "On the efficiency of certain quasi-random sequences of points", Numer. Math. 2, 1960.
pub(crate) fn start(index: usize, lower: &[f64], upper: &[f64]) -> Vec<f64> {
    const BASES: [usize; 24] =
        [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89];
    lower
        .iter()
        .zip(upper)
        .zip(BASES.into_iter().cycle())
        .map(|((low, high), base)| low + (high - low) * radical_inverse(index + 1, base))
        .collect()
}

/// The digits of `index` in `base`, mirrored at the radix point: a number in `0..1`.
fn radical_inverse(mut index: usize, base: usize) -> f64 {
    let (mut value, mut weight) = (0.0, 1.0 / base as f64);
    while index > 0 {
        value += (index % base) as f64 * weight;
        index /= base;
        weight /= base as f64;
    }
    value
}

/// Samples that a search runs on; its results are followed on all samples of the window.
pub(crate) const SEARCH_SAMPLES: usize = 64;
/// Samples on which starts are only sorted; the best of them are followed on more.
pub(crate) const SCREENING_SAMPLES: usize = 32;
/// Iterations that sort starts into hopeful and hopeless.
pub(crate) const SCREENING_ITERATIONS: u32 = 24;
/// Sets that a fit reports at most; twice as many minima are kept for further steps.
pub(crate) const REPORTED: usize = 3;
/// Sets whose weighted errors are within this factor of the best are reported: the record does not tell them apart.
pub(crate) const AS_GOOD: f64 = 1.01;
/// Two ends of which all numbers of their places differ by less than this are one minimum. Places are logarithms or
/// shares, so this is 1 %.
pub(crate) const APART: f64 = 0.01;

/// Bounds of a descent in the coordinates of a model. `cost_tolerance`: relative decrease of the cost below which it
/// ends.
pub(crate) fn bounds(coordinates: &Coordinates, max_iterations: u32, cost_tolerance: f64) -> Bounds {
    let (lower, upper) = coordinates.free.iter().map(|number| number.bounds).unzip();
    Bounds { lower, upper, max_iterations, cost_tolerance, slow: 0.0 }
}

/// Descends from every point, in parallel: the ends, least cost first, and the evaluations spent by all of them.
///
/// A point without a finite response has no end. Ends of equal cost keep the order of their points, so the result
/// does not depend on the number of threads.
pub(crate) fn all(problem: &impl Response, points: Vec<Vec<f64>>, bounds: &Bounds) -> (Vec<Optimum>, u64) {
    let ends: Vec<_> = points.par_iter().map(|point| descend(problem, point, bounds)).collect();
    let mut ends: Vec<Optimum> = ends.into_iter().flatten().collect();
    let evaluations = ends.iter().map(|m| m.evaluations).sum();
    ends.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    (ends, evaluations)
}

/// The best ends that are not at the place of a better one, the numbers of a place all nearer than [`APART`], twice as
/// many as are reported at most; `sorted` by cost, and so is the result.
pub(crate) fn distinct(coordinates: &Coordinates, sorted: Vec<Optimum>) -> Vec<Optimum> {
    let mut kept: Vec<(Optimum, Vec<f64>)> = Vec::new();
    for minimum in sorted {
        let here = coordinates.identity(&minimum.theta);
        let same = |there: &[f64]| here.iter().zip(there).all(|(a, b)| (a - b).abs() < APART);
        if kept.len() < 2 * REPORTED && !kept.iter().any(|(_, there)| same(there)) {
            kept.push((minimum, here));
        }
    }
    kept.into_iter().map(|(minimum, _)| minimum).collect()
}

/// Relative residual below which a minimum is the exact model: rounding of a response of size one.
const EXACT: f64 = 1e-14;
/// So many of the best starts are followed to convergence.
const FOLLOWED: usize = 4;
/// Steps along the weakest direction, in the coordinates, from which a descent starts once more.
const RESTARTS: [f64; 6] = [-0.6, 0.6, -0.2, 0.2, -0.05, 0.05];
/// Relative decrease of the cost from which a restart is followed to the end.
pub(crate) const WORTH_A_RESTART: f64 = 1e-3;
/// Until then a descent ends at steps that gain less than this share of it.
const PART_OF_A_RESTART: f64 = 0.01;
/// Rounds of such steps.
const ROUNDS: usize = 6;

/// Starts that are sorted side by side, after which a search asks whether it has seen enough.
const ROUND: usize = 8;
/// A place at which so many of them end, and none lower, is taken for the only one that is lower than all others.
const MET: usize = 3;

/// Where the descents of a search stay, and when they end.
pub(crate) fn bounds_of_search(coordinates: &Coordinates) -> Bounds {
    bounds(coordinates, 200, 1e-15)
}

/// Whether so many ends as [`MET`] are at the place of the first; `sorted` by cost.
fn is_met(coordinates: &Coordinates, sorted: &[Optimum]) -> bool {
    let Some(best) = sorted.first().map(|best| coordinates.identity(&best.theta)) else { return false };
    let is_there =
        |end: &&Optimum| coordinates.identity(&end.theta).iter().zip(&best).all(|(a, b)| (a - b).abs() < APART);
    sorted.iter().filter(is_there).count() >= MET
}

/// The distinct minima found, best first, and the evaluations spent.
///
/// A few iterations from the points, on a part of the samples, in rounds of eight until three of them ended at the best
/// place; the best are followed to convergence; then [`restarts`](restart).
pub(crate) fn multistart(coarse: &Problem<'_>, problem: &Problem<'_>, points: Vec<Vec<f64>>) -> (Vec<Optimum>, u64) {
    let bounds = bounds_of_search(problem.coordinates);
    let screening = Bounds { max_iterations: SCREENING_ITERATIONS, cost_tolerance: 1e-6, ..bounds.clone() };
    let (mut screened, mut evaluations) = (Vec::with_capacity(points.len()), 0);
    for round in points.chunks(ROUND) {
        let (ends, spent) = all(coarse, round.to_vec(), &screening);
        evaluations += spent;
        screened.extend(ends);
        screened.sort_by(|a: &Optimum, b| a.cost.total_cmp(&b.cost));
        if is_met(problem.coordinates, &screened) {
            break;
        }
    }
    let hopeful = distinct(problem.coordinates, screened).into_iter().take(FOLLOWED).map(|m| m.theta).collect();
    let (minima, spent) = all(problem, hopeful, &bounds);
    evaluations += spent;
    let (minima, spent) = restart(problem, minima);
    (minima, evaluations + spent)
}

/// The best end of descents from every point: by `sorting` from all and by `to_the_end` from the best `followed`, on at
/// most [`SEARCH_SAMPLES`] of each wave, then from the best of these on all samples. That end, whose steps are those of
/// the last descent, and the evaluations spent by all.
pub(crate) fn best_of_starts(
    problem: &Problem<'_>,
    points: Vec<Vec<f64>>,
    [sorting, to_the_end]: [&Bounds; 2],
    followed: usize,
) -> (Option<Optimum>, u64) {
    let thin = problem.observed.clone().thinned(SEARCH_SAMPLES);
    let coarse = Problem { unit: problem.unit, ..Problem::new(problem.coordinates, &thin, problem.exact) };
    let (mut ends, mut evaluations) = all(&coarse, points, sorting);
    for (compared, count) in [(&coarse, followed), (problem, 1)] {
        let points = ends.into_iter().take(count).map(|m| m.theta).collect();
        let (next, spent) = all(compared, points, to_the_end);
        (ends, evaluations) = (next, evaluations + spent);
    }
    (ends.into_iter().next(), evaluations)
}

/// Leaves the best minimum along its weakest direction, along which the error hardly rises and beyond which other
/// minima lie: from points on both sides of it the descent starts again, as long as that lowers the cost by 0.1 %.
///
/// On exact records of double models with four real poles the last three of twelve digits of error are won by these
/// restarts. The distinct minima, best first, and the evaluations spent; of restarts that were not followed, the ends
/// as they are: the caller follows all.
pub(crate) fn restart(problem: &Problem<'_>, minima: Vec<Optimum>) -> (Vec<Optimum>, u64) {
    let (coordinates, exact) = (problem.coordinates, EXACT * EXACT * problem.rows() as f64);
    let mut minima = distinct(coordinates, minima);
    let mut evaluations = 0;
    for _ in 0..ROUNDS {
        let Some(best) = minima.first() else { break };
        let before = best.cost;
        if before <= exact {
            break;
        }
        let Some(weak) = weakest_direction(best) else { break };
        let from = |restart: &f64| best.theta.iter().zip(&weak).map(|(x, w)| x + restart * w).collect();
        let to_the_end = bounds_of_search(coordinates);
        let near = Bounds { cost_tolerance: PART_OF_A_RESTART * WORTH_A_RESTART, ..to_the_end.clone() };
        let (more, spent) = all(problem, RESTARTS.iter().map(from).collect(), &near);
        evaluations += spent;
        let lower =
            more.first().filter(|end| end.cost <= (1.0 - WORTH_A_RESTART) * before).map(|end| end.theta.clone());
        let gained = lower.is_some();
        let (lowest, spent) = all(problem, lower.into_iter().collect(), &to_the_end);
        evaluations += spent;
        minima.extend(lowest.into_iter().chain(more));
        minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        minima = distinct(coordinates, minima);
        if !gained {
            break;
        }
    }
    (minima, evaluations)
}

/// The unit vector in the coordinates that changes the residuals least, among those not fixed at a bound: the right
/// singular vector of the smallest singular value.
pub(crate) fn weakest_direction(optimum: &Optimum) -> Option<Vec<f64>> {
    let free: Vec<usize> = (0..optimum.theta.len()).filter(|&i| !optimum.on_bound[i]).collect();
    let last = free.len().checked_sub(1)?;
    let svd = jacobi_svd(&optimum.r.select_columns(&free))?;
    let mut direction = vec![0.0; optimum.theta.len()];
    for (k, &i) in free.iter().enumerate() {
        direction[i] = svd.right[(k, last)];
    }
    Some(direction)
}

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
pub(crate) fn search(coordinates: &Coordinates, observed: &Observation, how: &Search) -> Option<Searched> {
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
fn multi_start(coarse: &Problem<'_>, problem: &Problem<'_>, count: usize, given: &[Vec<f64>]) -> (Vec<Optimum>, u64) {
    let (lower, upper): (Vec<f64>, Vec<f64>) = problem.coordinates.free.iter().map(|number| number.starts).unzip();
    let points = given.iter().cloned().chain((0..count).map(|k| start(k, &lower, &upper))).collect();
    multistart(coarse, problem, points)
}

/// L-SHADE over the box of the starts, half as wide again on each side within the bounds, then a descent from its
/// best point and restarts. The cost of the search is the sum of squared residuals.
fn global(problem: &Problem<'_>, options: &LShadeOptions, remarks: &mut Vec<String>) -> (Vec<Optimum>, u64) {
    let free = &problem.coordinates.free;
    // The box of the starts, wider by its half on each side where the bounds allow it.
    let edge = |x: f64, other: f64| x + 0.5 * (x - other);
    let lower: Vec<f64> = free.iter().map(|c| edge(c.starts.0, c.starts.1).max(c.bounds.0)).collect();
    let upper: Vec<f64> = free.iter().map(|c| edge(c.starts.1, c.starts.0).min(c.bounds.1)).collect();
    let theta =
        |unit: &[f64]| -> Vec<f64> { (0..unit.len()).map(|i| lower[i] + unit[i] * (upper[i] - lower[i])).collect() };
    let rows = problem.rows();
    let population = l_shade(free.len(), options, |unit| {
        let mut residuals = vec![0.0; rows];
        if problem.residuals(&theta(unit), &mut residuals) {
            residuals.iter().map(|r| r * r).sum()
        } else {
            f64::INFINITY
        }
    });
    let (minima, descent) = all(problem, vec![theta(&population.point)], &bounds_of_search(problem.coordinates));
    let (minima, restarts) = restart(problem, minima);
    let spent = descent + restarts;
    let level = |cost: f64| (cost / rows as f64).sqrt();
    remarks.push(format!(
        "L-SHADE in the unit box of {} logarithms: {} evaluations, seed {}, {}; the descent from its best point took \
         the weighted error from {:.3e} to {:.3e} in {} more",
        free.len(),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_are_spread_over_the_box() {
        let points: Vec<_> = (0..64).map(|k| start(k, &[-1.0; 4], &[1.0; 4])).collect();
        for axis in 0..4 {
            let positive = points.iter().filter(|p| p[axis] > 0.0).count();
            assert!((28..=36).contains(&positive), "axis {axis}: {positive} of 64");
        }
        assert_eq!(points[0][0], 0.0);
    }
}

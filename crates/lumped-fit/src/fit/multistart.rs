//! Search for the minima of an error: descents from many starts, then hops along the weakest direction.

use crumple_numerics::linalg::jacobi_svd;

use crate::fit::descents::{SCREENING_ITERATIONS, SEARCH_SAMPLES, all, bounds, distinct};
use crate::fit::problem::Problem;
use crate::free::coordinates::Coordinates;
use crate::free::parametric::Parametric;
use crumple_numerics::estimation::minimise::levenberg_marquardt::{Bounds, Optimum, Response};

/// Relative residual below which a minimum is the exact model: rounding of a response of size one.
const EXACT: f64 = 1e-14;
/// So many of the best starts are followed to convergence.
const FOLLOWED: usize = 4;
/// Steps along the weakest direction, in the coordinates, from which a descent starts once more.
const HOPS: [f64; 6] = [-0.6, 0.6, -0.2, 0.2, -0.05, 0.05];
/// Relative decrease of the cost from which a hop is followed to the end.
pub(crate) const WORTH_A_HOP: f64 = 1e-3;
/// Until then a descent ends at steps that gain less than this share of it.
const PART_OF_A_HOP: f64 = 0.01;
/// Rounds of such steps.
const ROUNDS: usize = 6;

/// Where the descents of a search stay, and when they end.
pub(crate) fn bounds_of_search(coordinates: &Coordinates<impl Parametric>) -> Bounds {
    bounds(coordinates, 200, 1e-15)
}

/// The distinct minima found, best first, and the evaluations spent.
///
/// A few iterations from every point, on a part of the samples; the best are followed to convergence; then
/// [`hops`](hop).
pub(crate) fn multistart<M: Parametric>(
    coarse: &Problem<'_, M>,
    problem: &Problem<'_, M>,
    points: Vec<Vec<f64>>,
) -> (Vec<Optimum>, u64) {
    let bounds = bounds_of_search(problem.coordinates);
    let screening = Bounds { max_iterations: SCREENING_ITERATIONS, cost_tolerance: 1e-6, ..bounds.clone() };
    let (screened, mut evaluations) = all(coarse, points, &screening);
    let hopeful = distinct(problem.coordinates, screened).into_iter().take(FOLLOWED).map(|m| m.theta).collect();
    let (minima, spent) = all(problem, hopeful, &bounds);
    evaluations += spent;
    let (minima, spent) = hop(problem, minima);
    (minima, evaluations + spent)
}

/// The best end of descents from every point: by `sorting` from all and by `to_the_end` from the best `followed`, on at
/// most [`SEARCH_SAMPLES`] of each wave, then from the best of these on all samples. That end, whose steps are those of
/// the last descent, and the evaluations spent by all.
pub(crate) fn best_of_starts(
    problem: &Problem<'_, impl Parametric>,
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
/// On exact records of double models with four real poles the last three of twelve digits of error are won by
/// these hops. The distinct minima, best first, and the evaluations spent; of hops that were not followed, the ends as
/// they are: the caller follows all.
pub(crate) fn hop(problem: &Problem<'_, impl Parametric>, minima: Vec<Optimum>) -> (Vec<Optimum>, u64) {
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
        let from = |hop: &f64| best.theta.iter().zip(&weak).map(|(x, w)| x + hop * w).collect();
        let to_the_end = bounds_of_search(coordinates);
        let near = Bounds { cost_tolerance: PART_OF_A_HOP * WORTH_A_HOP, ..to_the_end.clone() };
        let (more, spent) = all(problem, HOPS.iter().map(from).collect(), &near);
        evaluations += spent;
        let lower = more.first().filter(|end| end.cost <= (1.0 - WORTH_A_HOP) * before).map(|end| end.theta.clone());
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

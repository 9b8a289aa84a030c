//! Search for the minima of the double model's error, in the logarithms of two springs and two dampers.

use crumple_linalg::jacobi_svd;
use nalgebra::{DMatrix, Matrix4, Vector4};
use rayon::prelude::*;

use crate::fit::descents::{REPORTED, SCREENING_ITERATIONS};
use crate::fit::double::residuals::DoubleResiduals;
use crate::fit::halton_starts::start;
use crumple_estimation::minimise::levenberg_marquardt_4::{Minimum, Settings, minimise};

/// So many of the best starts are followed to convergence.
const FOLLOWED: usize = 4;
/// Steps along the weakest direction that a minimum is left by, in logarithms.
const HOPS: [f64; 6] = [-0.6, 0.6, -0.2, 0.2, -0.05, 0.05];
/// Rounds of hops.
const ROUNDS: usize = 6;
/// Relative residual below which a minimum is the exact model: rounding of displacements near 1 m.
const EXACT: f64 = 1e-14;

/// The distinct minima found, best first, and the model evaluations spent.
///
/// Multi-start Levenberg-Marquardt from Halton points, a few iterations each; the best are followed to convergence.
/// Then hops: the sensitivities of the best minimum have one weakest direction, along which the error hardly rises
/// and beyond which other minima lie; from points on both sides of it the descent starts again, as long as that
/// finds something better. On exact records with four real poles the last three of twelve digits of error are won
/// by these hops.
pub(crate) fn search(
    problem: &DoubleResiduals<'_>,
    starts: usize,
    settings: &Settings,
    lower: &Vector4<f64>,
    upper: &Vector4<f64>,
) -> (Vec<Minimum>, u64) {
    let screening = Settings { max_iterations: SCREENING_ITERATIONS, cost_tolerance: 1e-6, ..*settings };
    let points: Vec<_> = (0..starts).map(|k| start(k, lower, upper)).collect();
    let (screened, mut evaluations) = descend(problem, &points, &screening);
    let hopeful: Vec<_> = distinct(problem, screened, FOLLOWED).iter().map(|m| m.theta).collect();
    let (mut minima, spent) = descend(problem, &hopeful, settings);
    evaluations += spent;
    for _ in 0..ROUNDS {
        minima = distinct(problem, minima, 2 * REPORTED);
        let Some(best) = minima.first() else { break };
        let before = best.cost;
        if before <= EXACT * EXACT * problem.window.samples.len() as f64 {
            break;
        }
        let Some(weak) = weakest_direction(&best.r, best.on_bound) else { break };
        let points = HOPS.map(|hop| best.theta + weak * hop);
        let (ends, spent) = descend(problem, &points, settings);
        evaluations += spent;
        minima.extend(ends);
        minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        if minima[0].cost > 0.999 * before {
            break;
        }
    }
    (distinct(problem, minima, REPORTED), evaluations)
}

/// Descends from all points in parallel: minima sorted by cost, equal costs in the order of the points, and the
/// evaluations spent.
fn descend(problem: &DoubleResiduals<'_>, points: &[Vector4<f64>], settings: &Settings) -> (Vec<Minimum>, u64) {
    let ends: Vec<_> = points.par_iter().map(|point| minimise(problem, point, settings)).collect();
    let mut minima: Vec<Minimum> = ends.into_iter().flatten().collect();
    let evaluations = minima.iter().map(|m| m.evaluations).sum();
    minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    (minima, evaluations)
}

/// The first few minima, without those that are at the place of a better one or of its dual.
///
/// Places are compared by five numbers that a model and its dual share: the four coefficients of the characteristic
/// polynomial and the product of the dampers, in logarithms; nearer than 0.01 in all of them is the same place.
pub(crate) fn distinct(problem: &DoubleResiduals<'_>, sorted: Vec<Minimum>, limit: usize) -> Vec<Minimum> {
    // Equal for dual models, different otherwise.
    let invariant = |m: &Minimum| {
        let model = problem.model(&m.theta);
        let [_, t, u, v, w] = model.characteristic_polynomial();
        [t, u, v, w, model.c1_n_s_per_m * model.c2_n_s_per_m].map(f64::ln)
    };
    let mut kept: Vec<(Minimum, [f64; 5])> = Vec::with_capacity(limit);
    for minimum in sorted {
        let place = invariant(&minimum);
        let same = |other: &[f64; 5]| place.iter().zip(other).all(|(a, b)| (a - b).abs() < 0.01);
        if kept.len() < limit && !kept.iter().any(|(_, other)| same(other)) {
            kept.push((minimum, place));
        }
    }
    kept.into_iter().map(|(minimum, _)| minimum).collect()
}

/// Unit vector of the smallest singular value of the sensitivities, among parameters not fixed at a bound.
fn weakest_direction(r: &Matrix4<f64>, on_bound: [bool; 4]) -> Option<Vector4<f64>> {
    let mut free = *r;
    for i in (0..4).filter(|&i| on_bound[i]) {
        // A column longer than all others: its own singular direction, and never the weakest.
        free.column_mut(i).fill(0.0);
        free[(i, i)] = 2.0 * r.norm();
    }
    // Singular values come largest first.
    let svd = jacobi_svd(&DMatrix::from_column_slice(4, 4, free.as_slice()))?;
    let mut direction = Vector4::from_column_slice(svd.right.column(3).as_slice());
    for i in (0..4).filter(|&i| on_bound[i]) {
        direction[i] = 0.0;
    }
    (direction.norm() > 0.5).then_some(direction)
}

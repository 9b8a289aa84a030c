//! Descents from several points at once: their bounds, their ends in order, and which ends are distinct.

use crumple_numerics::estimation::minimise::levenberg_marquardt::{Bounds, Optimum, Response, descend};
use rayon::prelude::*;

use crate::free::coordinates::Coordinates;
use crate::free::parametric::Parametric;

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
pub(crate) fn bounds(coordinates: &Coordinates<impl Parametric>, max_iterations: u32, cost_tolerance: f64) -> Bounds {
    let axes = || coordinates.free.iter().map(|number| number.axis);
    Bounds {
        lower: axes().map(|axis| axis.lower).collect(),
        upper: axes().map(|axis| axis.upper).collect(),
        max_iterations,
        cost_tolerance,
        slow: 0.0,
    }
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
pub(crate) fn distinct(coordinates: &Coordinates<impl Parametric>, sorted: Vec<Optimum>) -> Vec<Optimum> {
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

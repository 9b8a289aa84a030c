//! Block bootstrap of the misfit.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;

use crate::judge::Intervals;
use crate::observed::{Observed, Problem};
use crate::refine::{Refined, follow};
use crumple_metrics::autocorrelation_time;

/// Replicates that say something of the ends of an interval.
pub const REPLICATES: usize = 200;
/// Seed of the generators; replicate `i` uses its stream `i`.
const SEED: u64 = 1;
/// A block is so many autocorrelation times long, and at most this share of the window.
const BLOCK_TIMES: f64 = 2.0;
const LARGEST_SHARE: usize = 3;

/// What the replicates say.
#[derive(Debug, Clone, PartialEq)]
pub struct Bootstrap {
    /// Replicates that led to a fit.
    pub replicates: usize,
    /// Samples in a block.
    pub block: usize,
    /// From the 2.5th to the 97.5th percentile.
    pub interval: Intervals,
}

/// Fits the model again to its own response with the misfit laid over it in shuffled blocks, and reads the percentiles.
///
/// Moving blocks on a circle (Politis & Romano 1992), two autocorrelation times long but at most a third of the window, so
/// that what hangs together stays together. Every replicate starts from the minimum and draws from its own stream of a fixed
/// seed: the result does not depend on threads. Says nothing of other minima, nor of an error that is the same in
/// the whole record. `None` with fewer than 20 fits, or for a misfit of rounding alone.
pub fn bootstrap(refined: &Refined, observed: &Observed, replicates: usize) -> Option<Bootstrap> {
    let n = refined.misfit_m.len();
    let block = ((BLOCK_TIMES * autocorrelation_time(&refined.misfit_m)).ceil() as usize).clamp(1, n / LARGEST_SHARE);
    let response: Vec<f64> = observed.displacement_m.iter().zip(&refined.misfit_m).map(|(x, r)| x + r).collect();
    let found: Vec<Option<Vec<f64>>> = (0..replicates)
        .into_par_iter()
        .map(|index| {
            let mut random = ChaCha8Rng::seed_from_u64(SEED);
            random.set_stream(index as u64);
            let mut displacement_m = response.clone();
            let mut k = 0;
            while k < n {
                let from = (random.next_u64() % n as u64) as usize;
                for step in 0..block.min(n - k) {
                    // The misfit is model minus record.
                    displacement_m[k + step] -= refined.misfit_m[(from + step) % n];
                }
                k += block;
            }
            let again = Observed { displacement_m, ..observed.clone() };
            let problem = Problem::new(refined.model, refined.free.clone(), &again);
            let optimum = follow(&problem, &problem.start())?;
            Some(problem.free.iter().zip(&optimum.theta).map(|(p, theta)| p.at(*theta)).collect())
        })
        .collect();
    let found: Vec<Vec<f64>> = found.into_iter().flatten().collect();
    if found.len() < 20 {
        return None;
    }
    let interval = refined
        .free
        .iter()
        .enumerate()
        .map(|(i, parameter)| {
            let mut values: Vec<f64> = found.iter().map(|f| f[i]).collect();
            (parameter.name, (percentile(&mut values, 0.025), percentile(&mut values, 0.975)))
        })
        .collect();
    Some(Bootstrap { replicates: found.len(), block, interval })
}

/// Percentile by linear interpolation between order statistics.
pub(crate) fn percentile(values: &mut [f64], share: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    let place = share * last as f64;
    let below = (place.floor() as usize).min(last);
    let above = (below + 1).min(last);
    Some(values[below] + (place - below as f64) * (values[above] - values[below]))
}

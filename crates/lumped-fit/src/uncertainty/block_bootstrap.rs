//! Block bootstrap of the misfit: intervals by fitting resampled records.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::record::observation::Observation;
use crumple_numerics::estimation::random::{RandomNumbers, circular_blocks};
use crumple_numerics::estimation::statistics::{geyer_autocorrelation_time, quantile};

/// Seed of the generators; replicate `i` uses its stream `i`.
const SEED: u64 = 1;
/// Length of a block in autocorrelation times of the misfit.
const BLOCK_TIMES: f64 = 2.0;
/// A block is at most one part in so many of the window.
const LARGEST_SHARE: usize = 3;

/// Percentiles of the parameters over the replicates.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockBootstrap {
    /// Replicates that led to a fit.
    pub replicates: usize,
    /// Samples in a block.
    pub block: usize,
    /// From the 2.5th to the 97.5th percentile.
    pub interval: BTreeMap<String, (Option<f64>, Option<f64>)>,
}

/// Fits the model to its own response with the misfit added in shuffled blocks, many times, and takes percentiles.
///
/// Moving blocks on a circle (Politis & Romano, "A circular block-resampling procedure for stationary data", 1992),
/// two autocorrelation times long but at most a third of the window, so that the correlation in time is kept. Several
/// waves are shuffled in the same blocks of time: an error that they share stays shared. Every replicate descends
/// from the minimum and draws from its own stream of a fixed seed, so the result does not depend on the number of
/// threads.
///
/// Contains no other minimum, and no error that is the same in the whole record. `misfit`: the weighted residuals;
/// `fit`: the values of `names` for a resampled record. `None` with fewer than 20 fits.
pub(crate) fn replicate(
    observed: &Observation,
    misfit: &[f64],
    replicates: usize,
    names: Vec<String>,
    fit: impl Fn(&Observation) -> Option<Vec<f64>> + Sync,
) -> Option<BlockBootstrap> {
    let misfits = observed.split(misfit);
    let n = misfits.first()?.len();
    // In samples of the first wave; the same blocks of time for all.
    let time = misfits
        .iter()
        .map(|samples| geyer_autocorrelation_time(samples) * n as f64 / samples.len() as f64)
        .fold(0.0, f64::max);
    let block = ((BLOCK_TIMES * time).ceil() as usize).clamp(1, n / LARGEST_SHARE);
    let fits: Vec<Option<Vec<f64>>> = (0..replicates)
        .into_par_iter()
        .map(|index| {
            let places = circular_blocks(&mut RandomNumbers::of_stream(SEED, index), n, block);
            let mut resampled = observed.clone();
            for (wave, misfit) in resampled.waves.iter_mut().zip(&misfits) {
                let samples = misfit.len();
                for (k, sample) in wave.samples.iter_mut().enumerate() {
                    let drawn = places[k * n / samples] * samples / n;
                    // The misfit is model minus record, times the weight.
                    *sample += (misfit[k] - misfit[drawn]) / wave.weight;
                }
            }
            fit(&resampled)
        })
        .collect();
    let fits: Vec<Vec<f64>> = fits.into_iter().flatten().collect();
    if fits.len() < 20 {
        return None;
    }
    let interval = names
        .into_iter()
        .enumerate()
        .map(|(i, name)| {
            let mut values: Vec<f64> = fits.iter().map(|f| f[i]).collect();
            (name, (percentile(&mut values, 0.025), percentile(&mut values, 0.975)))
        })
        .collect();
    Some(BlockBootstrap { replicates: fits.len(), block, interval })
}

/// The quantile `share` of values, by linear interpolation between order statistics; sorts them. `None` without
/// values.
pub(crate) fn percentile(values: &mut [f64], share: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    quantile(values, share)
}

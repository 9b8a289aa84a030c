//! How many samples of past and future a subspace method looks at.

use crate::okid::observer_regression::{Criterion, ObserverRegression, least};
use crate::{IoData, Subspace};

/// Lags that the criterion looks at, at most.
const HIGHEST_LAGS: usize = 40;

/// Columns of past and of future, at most: the work goes with their square.
const MOST_COLUMNS: usize = 200;

/// Block rows for every lag of the regression.
const PER_LAG: usize = 2;

/// Share of the record that a factorisation needs at most.
const LEAST_SHARE: usize = 2;

/// Singular values of the regression below this fraction of the largest tell that there is no noise.
const TRUNCATION: f64 = 1e-10;

/// Horizons to try, and where they come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Horizons {
    /// Block rows of past and of future, rising, the shortest allowed first.
    pub block_rows: Vec<usize>,
    /// Lags of the regression that the others follow from; `None`: there are no others.
    pub lags: Option<usize>,
}

/// The shortest horizon; and once and twice the number of lags that a regression of all outputs on the past of all
/// signals needs by Schwarz's criterion, as far as they are longer.
///
/// The state is a summary of the past for the future: where the regression gains from older samples, so does the
/// projection. Once is the rule of Bauer, Automatica 41 (2005), 359-376, twice that of Peternell, Scherrer & Deistler,
/// Signal Processing 52 (1996), 161-177. A horizon that is too long costs variance and time, one too short loses slow
/// and lightly damped modes; models of one order from several horizons have as many parameters and compare by their
/// simulation error.
///
/// At most 40 lags, 200 columns of past, and half of the samples. No others where the regression is singular: data
/// without noise, in which every horizon longer than the order is as good.
pub fn horizons(data: &IoData, shortest: usize) -> Horizons {
    let alone = Horizons { block_rows: vec![shortest], lags: None };
    let (m, q, samples) = (data.inputs().len(), data.outputs().len(), data.samples());
    let width = m + q;
    // What the factorisation needs grows by as much with every block row.
    let by_length = (samples / LEAST_SHARE + 1) / (2 + 2 * width) / PER_LAG;
    // What the criterion compares must be determined three times over.
    let by_regression = (samples / (3 * width)).saturating_sub(1);
    let by_columns = MOST_COLUMNS / width / PER_LAG;
    let highest = HIGHEST_LAGS.min(by_length).min(by_regression).min(by_columns);
    if highest * PER_LAG <= shortest {
        return alone;
    }
    let Ok(regression) = ObserverRegression::new(data, highest, true, TRUNCATION) else { return alone };
    if regression.solution.rank < regression.regressors {
        return alone;
    }
    match least(&regression.scan(Criterion::Bic)) {
        Some((lags, value)) if value.is_finite() && lags * PER_LAG > shortest => {
            debug_assert!(Subspace::needed(lags * PER_LAG, m, q) <= samples);
            let longer = [lags, lags * PER_LAG].into_iter().filter(|rows| *rows > shortest);
            Horizons { block_rows: std::iter::once(shortest).chain(longer).collect(), lags: Some(lags) }
        }
        _ => alone,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_estimation::random::uniform_at;

    /// One output that remembers its input for `memory` samples, with white noise.
    fn echo(memory: usize, noise: f64) -> IoData {
        let u: Vec<f64> = (0..2000).map(|k| uniform_at(1, k) - 0.5).collect();
        let y = (0..2000)
            .map(|k| u[k] + k.checked_sub(memory).map_or(0.0, |past| u[past]) + noise * (uniform_at(2, k) - 0.5))
            .collect();
        IoData::single(u, y, 1e-3).unwrap()
    }

    #[test]
    fn a_longer_memory_asks_for_a_longer_horizon() {
        for memory in [7, 15, 30] {
            let estimated = horizons(&echo(memory, 0.2), 10);
            let lags = estimated.lags.unwrap();
            // The echo is worth a regressor; the noise at most a few more.
            assert!((memory..=memory + 8).contains(&lags), "{memory}: {estimated:?}");
            assert_eq!(estimated.block_rows.last(), Some(&(2 * lags)));
        }
        assert_eq!(horizons(&echo(2, 0.2), 40), Horizons { block_rows: vec![40], lags: None });
    }

    #[test]
    fn short_records_and_those_without_noise_keep_the_shortest() {
        let short = echo(15, 0.2).slice(0, 60).unwrap();
        assert!(horizons(&short, 10).lags.is_none());
        let wave: Vec<f64> = (0..500).map(|k| (-0.01 * f64::from(k)).exp() * (0.3 * f64::from(k)).cos()).collect();
        let clean = IoData::new(Vec::new(), vec![wave], 1e-3).unwrap();
        assert_eq!(horizons(&clean, 10), Horizons { block_rows: vec![10], lags: None });
    }
}

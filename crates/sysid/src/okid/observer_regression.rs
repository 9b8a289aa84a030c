//! Regression of every output on past inputs and outputs, and the choice of the number of lags.

use crate::regression::lagged_regression::{LaggedRegression, LaggedSolution};
use crate::{IdentifyError, InformationCriteria, IoData};

/// How the number of lags is chosen among several.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// Akaike's for short records: leans towards many.
    Aicc,
    /// Schwarz's: leans towards few.
    Bic,
}

/// Outputs by the inputs of the same sample and by inputs and outputs of the last `lags` samples, in units of the root
/// mean square of each signal.
///
/// `y[k] = D u[k] + sum_(i=1..p) (Yb1_i u[k-i] + Yb2_i y[k-i]) + e[k]`: a vector ARX model whose coefficients are the
/// Markov parameters of a deadbeat observer; in noise and with `p` large, of the Kalman filter.
pub(crate) struct ObserverRegression {
    pub(crate) solution: LaggedSolution,
    /// Regressors: the inputs of the same sample, then of every lag, nearest first, inputs and outputs.
    pub(crate) regressors: usize,
    /// Inputs of the same sample.
    pub(crate) direct: usize,
    /// Past samples `p`.
    lags: usize,
    /// Equations: samples less the lags.
    rows: usize,
    /// Inputs and outputs together, regressors of every lag.
    signals: usize,
}

impl ObserverRegression {
    /// The first `lags` samples only serve as past. Errors: fewer than two samples a regressor, silent outputs.
    pub(crate) fn new(data: &IoData, lags: usize, direct: bool, truncation: f64) -> Result<Self, IdentifyError> {
        let (m, q, samples) = (data.inputs().len(), data.outputs().len(), data.samples());
        let direct = if direct { m } else { 0 };
        let regressors = direct.saturating_add(lags.saturating_mul(m + q));
        let needed = regressors.saturating_mul(2).saturating_add(lags);
        if lags == 0 || samples <= needed {
            return Err(IdentifyError::TooShort {
                method: "okid",
                samples,
                needed: needed.max(2) + 1,
                why: format!("{lags} lags of {m} inputs and {q} outputs"),
            });
        }
        if data.outputs().iter().all(|y| y.iter().all(|x| *x == 0.0)) {
            return Err(IdentifyError::Silent("outputs"));
        }
        let (input_scales, output_scales) = (data.input_scales(), data.output_scales());
        let signals: Vec<Vec<f64>> = data
            .inputs()
            .iter()
            .zip(&input_scales)
            .chain(data.outputs().iter().zip(&output_scales))
            .map(|(signal, scale)| signal.iter().map(|x| x / scale).collect())
            .collect();
        let mut columns: Vec<(usize, usize)> = (0..direct).map(|j| (j, lags)).collect();
        for lag in 1..=lags {
            columns.extend((0..m + q).map(|s| (s, lags - lag)));
        }
        columns.extend((m..m + q).map(|s| (s, lags)));
        let rows = samples - lags;
        let regression =
            LaggedRegression { signals: signals.iter().map(Vec::as_slice).collect(), columns, targets: q, rows };
        let solution = regression.solve(truncation)?;
        Ok(Self { solution, regressors, direct, lags, rows, signals: m + q })
    }

    /// The criterion of 1, 2, ... lags, all compared on the same samples.
    ///
    /// From one factorisation: regressors stand in the order of their lags, so that the squares left by the leading
    /// ones are those of every smaller number of lags. Returned as `(lags, criterion)`, summed over outputs.
    pub(crate) fn scan(&self, criterion: Criterion) -> Vec<(usize, f64)> {
        let rows = self.rows as f64;
        (1..=self.lags)
            .map(|lags| {
                let parameters = self.direct + lags * self.signals;
                // Outputs taken for independent; criteria of independent fits add up.
                let value = self.solution.squares[parameters].iter().map(|square| {
                    let criteria = InformationCriteria::new(square / rows, rows, parameters);
                    if criterion == Criterion::Aicc { criteria.aicc } else { criteria.bic }
                });
                (lags, value.sum())
            })
            .collect()
    }
}

/// The number of lags from 1 to `highest` with the least criterion.
pub(crate) fn least(scan: &[(usize, f64)]) -> Option<(usize, f64)> {
    scan.iter().copied().reduce(|best, next| if next.1 < best.1 { next } else { best })
}

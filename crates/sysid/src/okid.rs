//! Observer/Kalman filter identification: Markov parameters of system and observer from any input and output.

use crumple_numerics::lti::StateSpace;
use nalgebra::DMatrix;

use crate::era::realization::input_matrix_of;
use crate::regression::lagged_regression::{LaggedRegression, LaggedSolution};
use crate::{Era, EraOptions, IdentifyError, InformationCriteria, IoData, MarkovParameters, Order};

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

// Observer/Kalman filter identification (OKID).

/// Growth of Markov parameters beyond the lags that counts as divergence.
const DIVERGED: f64 = 10.0;

/// Markov parameters computed, at least and for every lag.
const PARAMETERS: (usize, usize) = (200, 10);

/// Number of past samples that the observer sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lags {
    /// As given.
    Given(usize),
    /// The best by a criterion from 1 to the highest, all compared on the same samples.
    Best {
        /// Highest number.
        highest: usize,
        /// The criterion.
        criterion: Criterion,
    },
}

/// Settings of [`Okid::new`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OkidOptions {
    /// Lags: the order divided by the number of outputs at least, two to four times as many in noise.
    pub lags: Lags,
    /// Whether outputs may follow an input within the same sample.
    pub direct: bool,
    /// Markov parameters to compute; `None`: ten for every lag, 200 at least, not more than samples.
    pub parameters: Option<usize>,
    /// Singular values of the regression below this fraction of the largest are left out: collinear outputs.
    pub truncation: f64,
}

impl OkidOptions {
    /// A direct term, truncation at 1e-10.
    pub fn new(lags: Lags) -> Self {
        Self { lags, direct: true, parameters: None, truncation: 1e-10 }
    }
}

/// Markov parameters of a system and of its observer gain, from any input and output.
#[derive(Debug, Clone, PartialEq)]
pub struct Okid {
    /// Lags used.
    pub lags: usize,
    /// Candidates and the value of the criterion; empty where lags were given.
    pub scan: Vec<(usize, f64)>,
    /// Numerical rank of the regression, of `regressors`.
    pub rank: usize,
    /// Number of regressors.
    pub regressors: usize,
    /// Largest of the last Markov parameters over the largest within the lags; above 10 is divergence.
    pub growth: f64,
    /// In units of the root mean square of each signal: of every output `i` first those of the inputs, `h`, then those
    /// of the gain, `o`, whose sample 0 is 0.
    sequences: Vec<Vec<f64>>,
    input_scales: Vec<f64>,
    output_scales: Vec<f64>,
    sample_time_s: f64,
}

/// A model from OKID.
#[derive(Debug, Clone, PartialEq)]
pub struct OkidModel {
    /// Sampled model.
    pub model: StateSpace,
    /// Kalman gain `K`, states x outputs: the predictor is `x[k+1] = A x + B u + K (y - C x - D u)`.
    pub kalman_gain: DMatrix<f64>,
    /// Leading singular values of the Hankel matrix, in scaled units, and bounds of their errors.
    pub singular_values: Vec<(f64, f64)>,
}

impl OkidModel {
    /// The one-step predictor as a model: inputs are those of the system, then its measured outputs.
    pub fn predictor(&self) -> Result<StateSpace, IdentifyError> {
        let StateSpace { a, b, c, d, sample_time_s, .. } = &self.model;
        let k = &self.kalman_gain;
        let (n, m, q) = (a.nrows(), b.ncols(), c.nrows());
        let corrected = b - k * d;
        let b = DMatrix::from_fn(n, m + q, |i, j| if j < m { corrected[(i, j)] } else { k[(i, j - m)] });
        let d = DMatrix::from_fn(q, m + q, |i, j| if j < m { d[(i, j)] } else { 0.0 });
        Ok(StateSpace::new(a - k * c, b, c.clone(), d, *sample_time_s)?)
    }
}

impl Okid {
    /// Regresses every output on the inputs at the same sample and on inputs and outputs of the last `p` samples, then
    /// takes the observer apart: with `Yb1_k`, `-Yb2_k` the coefficients of inputs and outputs `k` samples ago,
    /// `h_0 = D`, `h_k = Yb1_k - sum_i Yb2_i h_(k-i)` and `o_k = Yb2_k - sum_(i<k) Yb2_i o_(k-i)` (the gain is
    /// `G = -K`). Signals are divided by their root mean square first. The first `p` samples only serve as past, for
    /// the record need not start from rest.
    ///
    /// The recursion runs beyond the lags, and grows without bound where the regression has a root outside the unit
    /// circle, as in coloured noise. This is [`IdentifyError::Diverged`], and nothing is passed on.
    ///
    /// Juang, Phan, Horta & Longman, J. Guidance 16(2), 1993; Juang, *Applied System Identification*, 1994.
    pub fn new(data: &IoData, options: OkidOptions) -> Result<Self, IdentifyError> {
        let okid = Self::unchecked(data, options)?;
        if okid.growth > DIVERGED {
            return Err(IdentifyError::Diverged { growth: okid.growth, lags: okid.lags });
        }
        Ok(okid)
    }

    fn unchecked(data: &IoData, options: OkidOptions) -> Result<Self, IdentifyError> {
        let (m, q, samples) = (data.inputs().len(), data.outputs().len(), data.samples());
        let lags = match options.lags {
            Lags::Given(lags) | Lags::Best { highest: lags, .. } => lags,
        };
        let ObserverRegression { solution, regressors, direct, .. } = match options.lags {
            Lags::Given(lags) => ObserverRegression::new(data, lags, options.direct, options.truncation)?,
            Lags::Best { highest, criterion } => {
                let scan = ObserverRegression::new(data, highest, options.direct, options.truncation)?.scan(criterion);
                let best = least(&scan).map_or(highest, |(lags, _)| lags);
                let again = Self::unchecked(data, OkidOptions { lags: Lags::Given(best), ..options })?;
                return Ok(Self { scan, ..again });
            }
        };
        let (input_scales, output_scales) = (data.input_scales(), data.output_scales());

        let coefficient = |i: usize, lag: usize, s: usize| solution.coefficients[(direct + (lag - 1) * (m + q) + s, i)];
        let outputs = |lag: usize| DMatrix::from_fn(q, q, |i, j| -coefficient(i, lag, m + j));
        let mut first = DMatrix::zeros(q, m + q);
        for i in 0..q {
            for j in 0..direct {
                first[(i, j)] = solution.coefficients[(j, i)];
            }
        }
        let count = options.parameters.unwrap_or(PARAMETERS.0.max(PARAMETERS.1 * lags)).clamp(lags + 1, samples);
        let recursion: Vec<DMatrix<f64>> = (1..=lags).map(outputs).collect();
        let mut parameters = vec![first];
        for k in 1..=count {
            let mut next = DMatrix::zeros(q, m + q);
            if k <= lags {
                for i in 0..q {
                    for s in 0..m + q {
                        next[(i, s)] = if s < m { coefficient(i, k, s) } else { -coefficient(i, k, s) };
                    }
                }
            }
            for (i, past) in recursion.iter().enumerate().take(k) {
                next.gemm(-1.0, past, &parameters[k - 1 - i], 1.0);
            }
            parameters.push(next);
        }
        // Without an input the gain's parameters are all there are.
        let columns = if m > 0 { m } else { q };
        let norm = |h: &DMatrix<f64>| h.columns(0, columns).norm();
        let largest = parameters[..=lags].iter().map(norm).fold(0.0, f64::max);
        // A parameter that has overflowed is not finite, and its norm not a number.
        let last = parameters[count + 1 - lags..]
            .iter()
            .map(norm)
            .fold(0.0, |m, x| if x.is_finite() { x.max(m) } else { f64::INFINITY });
        let finite = parameters.iter().all(|h| h.iter().all(|x| x.is_finite()));
        let growth = if finite && largest > 0.0 { last / largest } else { f64::INFINITY };
        let sequences = (0..q)
            .flat_map(|i| (0..m + q).map(move |s| (i, s)))
            .map(|place| parameters.iter().map(|h| h[place]).collect())
            .collect();
        Ok(Self {
            lags,
            scan: Vec::new(),
            rank: solution.rank,
            regressors,
            growth,
            sequences,
            input_scales,
            output_scales,
            sample_time_s: data.sample_time_s(),
        })
    }

    /// Markov parameters of the system, from input `j` to output `i`, in the units of the data; the first is the direct
    /// term.
    pub fn system(&self, i: usize, j: usize) -> Vec<f64> {
        let scale = self.output_scales[i] / self.input_scales[j];
        let width = self.input_scales.len() + self.output_scales.len();
        self.sequences[i * width + j].iter().map(|h| h * scale).collect()
    }

    /// Markov parameters of the observer gain, `C A^(k-1) G` with `G = -K`, from output `j` to output `i`.
    pub fn gain(&self, i: usize, j: usize) -> Vec<f64> {
        let scale = self.output_scales[i] / self.output_scales[j];
        let m = self.input_scales.len();
        let width = m + self.output_scales.len();
        self.sequences[i * width + m + j].iter().map(|o| o * scale).collect()
    }

    /// The model of one order by ERA on the sequences of the system, the gain then fitted by least squares to
    /// `C A^(k-1) G`; without an input by ERA on those of the gain. [`Order::Automatic`] considers orders up to 20.
    ///
    /// The gain takes no part in the choice of states. (In the published form it does: where it is large, the states
    /// that few inputs move are lost first, and where the regression is rank-deficient it has states of its own.)
    pub fn realize(&self, order: Order) -> Result<OkidModel, IdentifyError> {
        let (m, q) = (self.input_scales.len(), self.output_scales.len());
        let width = if m == 0 { q } else { m };
        let sequence = |i: usize, s: usize| self.sequences[i * (m + q) + s].as_slice();
        let sequences = (0..q).flat_map(|i| (0..width).map(move |s| (i, s))).map(|(i, s)| sequence(i, s)).collect();
        let markov = MarkovParameters::new(sequences, width)?;
        let realized = Era::from_markov(markov, EraOptions::new(self.sample_time_s), &[order])?.realize(order)?;
        let n = realized.order();
        let StateSpace { a, b, c, d, .. } = realized.discrete;
        let gain = if m == 0 {
            b.clone()
        } else {
            let gains: Vec<Vec<&[f64]>> = (0..q).map(|i| (0..q).map(|j| &sequence(i, m + j)[1..]).collect()).collect();
            input_matrix_of(&a, &c, &gains)
                .ok_or(IdentifyError::NotConverged("the least-squares fit of the observer gain"))?
        };
        let b = DMatrix::from_fn(n, m, |s, j| b[(s, j)] / self.input_scales[j]);
        let kalman_gain = DMatrix::from_fn(n, q, |s, i| -gain[(s, i)] / self.output_scales[i]);
        let c = DMatrix::from_fn(q, n, |i, s| c[(i, s)] * self.output_scales[i]);
        let d = DMatrix::from_fn(q, m, |i, j| d[(i, j)] * self.output_scales[i] / self.input_scales[j]);
        let singular_values = realized.singular_values.into_iter().zip(realized.singular_value_errors).collect();
        Ok(OkidModel { model: StateSpace::new(a, b, c, d, Some(self.sample_time_s))?, kalman_gain, singular_values })
    }
}

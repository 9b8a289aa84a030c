//! Subspace identification (N4SID, MOESP, CVA) and its horizon.

use crumple_numerics::linalg::{jacobi_svd, numerical_rank, pseudo_inverse_times};
use crumple_numerics::lti::{Complex, InputHold, StateSpace, eigenvalues, matrix_exponential, to_continuous};
use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::okid::{Criterion, ObserverRegression, least};
use crate::regression::data_triangle::triangular_factor;
use crate::regression::shifted_products::triangular_factor_by_products;
use crate::simulation::input_matrices::input_matrices;
use crate::simulation::mirrored_poles::stabilized;
use crate::{IdentifyError, IoData};

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

// Subspace identification: N4SID, MOESP and CVA.

/// Singular values of the inputs below this fraction of the largest excite nothing that a record in `f64` can show.
const SILENT: f64 = 1e-10;

/// Settings of [`Subspace::new`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SubspaceOptions {
    /// Weighting.
    pub weighting: Weighting,
    /// Block rows of past and of future; more than the order divided by the number of outputs.
    pub block_rows: usize,
    /// Whether outputs may follow an input within the same sample.
    pub direct: bool,
}

/// A model from a subspace method.
#[derive(Debug, Clone, PartialEq)]
pub struct SubspaceModel {
    /// Sampled model.
    pub model: StateSpace,
    /// State at the first sample of the record.
    pub initial_state: Vec<f64>,
    /// Growing poles that were mirrored at the unit circle so that the model can be simulated.
    pub reflected_poles: usize,
}

/// A factorised record, from which models of several orders follow at little cost.
#[derive(Debug, Clone)]
pub struct Subspace<'a> {
    data: &'a IoData,
    options: SubspaceOptions,
    singular_values: Vec<f64>,
    /// Extended observability matrix, unweighted, one column per singular value.
    observability: DMatrix<f64>,
    output_scales: Vec<f64>,
    /// Triangular factor of future and past inputs.
    inputs: DMatrix<f64>,
}

impl<'a> Subspace<'a> {
    /// Samples that a factorisation needs at least: as many columns as rows of the data matrices.
    pub fn needed(block_rows: usize, inputs: usize, outputs: usize) -> usize {
        2 * block_rows - 1 + 2 * block_rows * (inputs + outputs)
    }

    /// Factorises `[U_f; W_p; Y_f] = L Q'`, past inputs and outputs `W_p`, and takes the singular values of the
    /// weighted projection of `Y_f` on `W_p` along `U_f`. Signals are divided by their root mean square first.
    ///
    /// `L` comes from inner products, of which those of shifted copies follow from one another, where no column is near
    /// a combination of others (to about 1e-12); else from QR.
    ///
    /// Van Overschee & De Moor, *Subspace Identification for Linear Systems*, 1996, ch. 4 and 6.
    pub fn new(data: &'a IoData, options: SubspaceOptions) -> Result<Self, IdentifyError> {
        let i = options.block_rows;
        let (m, q) = (data.inputs().len(), data.outputs().len());
        let width = 2 * i * (m + q);
        let samples = data.samples();
        let needed = 2 * i - 1 + width;
        if i < 2 || samples < needed {
            return Err(IdentifyError::TooShort {
                method: options.weighting.name(),
                samples,
                needed: needed.max(2 * (m + q) * 2 + 3),
                why: format!("{i} block rows of {m} inputs and {q} outputs"),
            });
        }
        let output_scales = data.output_scales();
        let scaled = |signals: &[Vec<f64>], scales: &[f64]| -> Vec<Vec<f64>> {
            signals.iter().zip(scales).map(|(s, scale)| s.iter().map(|x| x / scale).collect()).collect()
        };
        let u = scaled(data.inputs(), &data.input_scales());
        let y = scaled(data.outputs(), &output_scales);
        if data.outputs().iter().all(|y| y.iter().all(|x| *x == 0.0)) {
            return Err(IdentifyError::Silent("outputs"));
        }
        // Column order: future inputs, past inputs, past outputs, future outputs.
        let signals: Vec<&[f64]> = u.iter().chain(&y).map(Vec::as_slice).collect();
        let mut columns: Vec<(usize, usize)> = Vec::with_capacity(width);
        for (of, offset) in [(0..m, i), (0..m, 0), (m..m + q, 0), (m..m + q, i)] {
            for k in 0..i {
                columns.extend(of.clone().map(|s| (s, offset + k)));
            }
        }
        let rows = samples + 1 - 2 * i;
        let r = match triangular_factor_by_products(&signals, &columns, rows) {
            Some(r) => r,
            None => {
                let stretches: Vec<(&[f64], usize)> = columns.iter().map(|(s, from)| (signals[*s], *from)).collect();
                triangular_factor(&stretches, rows).matrix()
            }
        };
        let inputs = r.view((0, 0), (2 * m * i, 2 * m * i)).into_owned();
        let failed = || IdentifyError::NotConverged("the singular value decomposition of a subspace method");
        let Projection { transposed, back } =
            options.weighting.projection(&r, m * i, (m + q) * i, q * i).ok_or_else(failed)?;
        let reduced = if transposed.nrows() > transposed.ncols() { transposed.qr().r() } else { transposed };
        let square = if reduced.nrows() < reduced.ncols() {
            let n = reduced.ncols();
            reduced.resize_vertically(n, 0.0)
        } else {
            reduced
        };
        let svd = jacobi_svd(&square).ok_or_else(failed)?;
        let mut vectors = svd.right;
        // Signs are free: the largest entry of every vector is made positive.
        for mut column in vectors.column_iter_mut() {
            let largest = column.iter().fold(0.0_f64, |best, x| if x.abs() > best.abs() { *x } else { best });
            if largest < 0.0 {
                column.neg_mut();
            }
        }
        let observability = match back {
            Some(back) => back * vectors,
            None => vectors,
        };
        Ok(Self { data, options, singular_values: svd.values, observability, output_scales, inputs })
    }

    /// Singular values of the weighted projection, largest first: evidence for the order. Those of CVA are the
    /// canonical correlations, 1 at most.
    pub fn singular_values(&self) -> &[f64] {
        &self.singular_values
    }

    /// Of the independent inputs that a model could be told by, `2 inputs block_rows`, how many the record has.
    ///
    /// Fewer: the inputs satisfy a difference equation of their own. Then what they drive and what moves freely cannot
    /// be told apart, and poles found are those of some model that explains the record. A crash record from the contact
    /// on is the extreme case: all its signals are sums of the same few exponentials.
    pub fn excitation(&self) -> (usize, usize) {
        let full = self.inputs.ncols();
        let excited = jacobi_svd(&self.inputs).map_or(full, |svd| {
            let tolerance = svd.values.first().copied().unwrap_or(0.0) * SILENT;
            svd.values.iter().take_while(|s| **s > tolerance).count()
        });
        (excited, full)
    }

    /// Highest order that can be realised.
    pub fn highest_order(&self) -> usize {
        let rows = self.data.outputs().len() * (self.options.block_rows - 1);
        rows.min(numerical_rank(&self.singular_values))
    }

    /// Extended observability matrix, one column per singular value, of outputs divided by their scales; and the number
    /// of outputs.
    pub(crate) fn observability(&self) -> (&DMatrix<f64>, usize) {
        (&self.observability, self.output_scales.len())
    }

    /// Root mean square of every output.
    pub(crate) fn output_scales(&self) -> &[f64] {
        &self.output_scales
    }

    /// Poles of the model of one order, growing ones as they are.
    pub(crate) fn poles(&self, order: usize) -> Result<Vec<Complex>, IdentifyError> {
        Ok(eigenvalues(&self.shifted(order)?.0)?)
    }

    /// The model of one order: `C` from the first block row, `A` by shift invariance (least squares), then `B`, `D`,
    /// `x0` by least squares on the simulated output. Growing poles are mirrored at the unit circle first, and counted.
    pub fn realize(&self, order: usize) -> Result<SubspaceModel, IdentifyError> {
        if order == 0 {
            return Err(IdentifyError::OrderZero);
        }
        let (a, c) = self.shifted(order)?;
        let (a, c, reflected_poles) = stabilized(a, c, self.data.samples())?;
        let (model, initial_state) = input_matrices(&a, &c, self.data, self.options.direct)?;
        Ok(SubspaceModel { model, initial_state, reflected_poles })
    }

    /// The same where this factorisation is of a [`thinned`](crate::thinned()) record: poles and mode shapes of the
    /// thinned one, taken to the sampling interval of `whole` by the logarithm; `B`, `D`, `x0` by least squares on
    /// `whole`.
    ///
    /// A negative real pole of the thinned model gets a conjugate (see [`to_continuous`]) and so one more state.
    /// Errors: a pole near zero, which no sampling interval but its own can have.
    pub fn realize_on(&self, order: usize, whole: &IoData) -> Result<SubspaceModel, IdentifyError> {
        if order == 0 {
            return Err(IdentifyError::OrderZero);
        }
        let (a, c) = self.shifted(order)?;
        let (n, q) = (a.nrows(), c.nrows());
        let no_input = (DMatrix::zeros(n, 0), DMatrix::zeros(q, 0));
        let thin = StateSpace::new(a, no_input.0, c, no_input.1, Some(self.data.sample_time_s()))?;
        let continuous = to_continuous(&thin, InputHold::Zero)?.model;
        let a = matrix_exponential(&(&continuous.a * whole.sample_time_s()))?;
        let (a, c, reflected_poles) = stabilized(a, continuous.c, whole.samples())?;
        let (model, initial_state) = input_matrices(&a, &c, whole, self.options.direct)?;
        Ok(SubspaceModel { model, initial_state, reflected_poles })
    }

    /// `A` by shift invariance and `C`, in units of the data.
    fn shifted(&self, order: usize) -> Result<(DMatrix<f64>, DMatrix<f64>), IdentifyError> {
        let method = self.options.weighting.name();
        if order > self.highest_order() {
            return Err(IdentifyError::OrderTooHigh { method, order, highest: self.highest_order() });
        }
        let q = self.output_scales.len();
        let rows = self.observability.nrows() - q;
        let upper = self.observability.view((0, 0), (rows, order)).into_owned();
        let lower = self.observability.view((q, 0), (rows, order)).into_owned();
        let a = pseudo_inverse_times(&upper, &lower)
            .ok_or(IdentifyError::NotConverged("the shift of a subspace method"))?;
        let c = DMatrix::from_fn(q, order, |i, k| self.observability[(i, k)] * self.output_scales[i]);
        Ok((a, c))
    }

    /// Several orders, in parallel, in the order given.
    pub fn realize_all(&self, orders: &[usize]) -> Vec<Result<SubspaceModel, IdentifyError>> {
        orders.par_iter().map(|order| self.realize(*order)).collect()
    }
}

// The weighted projections of the subspace methods.
//
// The extended observability matrix is the column space of what past inputs and outputs tell of future outputs. The
// three methods weigh that projection differently before its singular values are taken, and differ in nothing else:
// Van Overschee & De Moor, *Subspace Identification for Linear Systems*, 1996.

/// How the projection of the future on the past is weighted before its singular values are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weighting {
    /// The oblique projection as it is (Van Overschee & De Moor 1994).
    N4sid,
    /// Without the part that future inputs explain (Verhaegen 1994).
    Moesp,
    /// Canonical correlations: in units of what the past leaves unexplained (Larimore 1990).
    Cva,
}

impl Weighting {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::N4sid, Self::Moesp, Self::Cva];

    /// Name of the method: `n4sid`, `moesp`, `cva`.
    pub fn name(self) -> &'static str {
        match self {
            Self::N4sid => "n4sid",
            Self::Moesp => "moesp",
            Self::Cva => "cva",
        }
    }
}

/// The transposed weighted projection of future outputs on the past, tall, and what takes its right vectors back to the
/// extended observability matrix; `None`: they are it.
pub(crate) struct Projection {
    /// Rows x future outputs; its right singular vectors are the directions of the observability matrix.
    pub(crate) transposed: DMatrix<f64>,
    /// What undoes a weighting of the outputs.
    pub(crate) back: Option<DMatrix<f64>>,
}

impl Weighting {
    /// The projection from the triangular factor `r` of `[U_f; W_p; Y_f]'`: `future` columns of future inputs, `past`
    /// of past inputs and outputs, `outputs` of future outputs. `None`: a decomposition does not converge.
    ///
    /// MOESP takes `L32`, N4SID the oblique projection `L32 L22^+ [L21 L22]`, CVA `L32` divided by the square root of
    /// the covariance of the future outputs without the part of future inputs.
    pub(crate) fn projection(self, r: &DMatrix<f64>, future: usize, past: usize, outputs: usize) -> Option<Projection> {
        let part = |row: usize, rows: usize, column: usize, columns: usize| {
            r.view((row, column), (rows, columns)).into_owned()
        };
        // L = R': L32 is R23', and so on.
        let r22 = part(future, past, future, past);
        let r23 = part(future, past, future + past, outputs);
        let r33 = part(future + past, outputs, future + past, outputs);
        let (transposed, back) = match self {
            Self::Moesp => (r23, None),
            Self::N4sid => {
                // L32 L22^+ [L21 L22], transposed.
                let r12 = part(0, future, future, past);
                let coefficients = pseudo_inverse_times(&r22, &r23)?;
                let mut projection = DMatrix::zeros(future + past, outputs);
                projection.rows_mut(0, future).copy_from(&(r12 * &coefficients));
                projection.rows_mut(future, past).copy_from(&(&r22 * &coefficients));
                (projection, None)
            }
            Self::Cva => {
                let mut both = DMatrix::zeros(past + outputs, outputs);
                both.rows_mut(0, past).copy_from(&r23);
                both.rows_mut(past, outputs).copy_from(&r33);
                let svd = jacobi_svd(&both.qr().r())?;
                let rank = numerical_rank(&svd.values);
                let basis = svd.right.columns(0, rank).into_owned();
                let values = &svd.values[..rank];
                let mut weighted = r23 * &basis;
                let mut back = basis;
                for (k, s) in values.iter().enumerate() {
                    weighted.column_mut(k).unscale_mut(*s);
                    back.column_mut(k).scale_mut(*s);
                }
                (weighted, Some(back))
            }
        };
        Some(Projection { transposed, back })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::estimation::random::uniform_at;
    use crumple_numerics::lti::simulate;

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

    #[test]
    fn clean_data_of_two_inputs_and_outputs_give_poles_and_response_back() {
        let a = nalgebra::dmatrix![0.9, 0.3, 0.0; -0.3, 0.9, 0.1; 0.0, 0.0, 0.5];
        let b = nalgebra::dmatrix![1.0, 0.0; 0.5, -1.0; 0.2, 2.0];
        let c = nalgebra::dmatrix![1.0, 0.0, 0.3; 0.0, 1.0, -1.0];
        let truth = StateSpace::new(a, b, c, DMatrix::from_element(2, 2, 0.1), Some(0.01)).unwrap();
        let u: Vec<Vec<f64>> = (0..2).map(|j| (0..400).map(|k| 1e4 * (uniform_at(j, k) - 0.5)).collect()).collect();
        let y = simulate(&truth, &u, &[100.0, 0.0, 0.0]).unwrap();
        let data = IoData::new(u, y, 0.01).unwrap();
        for weighting in Weighting::ALL {
            let subspace = Subspace::new(&data, SubspaceOptions { weighting, block_rows: 6, direct: true }).unwrap();
            let values = subspace.singular_values();
            assert!(values.get(3).is_none_or(|fourth| *fourth < 1e-10 * values[2]), "{}: {values:?}", weighting.name());
            let estimated = subspace.realize(3).unwrap();
            for (estimated, exact) in estimated.model.poles().unwrap().iter().zip(truth.poles().unwrap()) {
                // Rounding times the condition of the past, about 1e3.
                assert!((estimated - exact).norm() < 1e-10, "{}: {estimated} {exact}", weighting.name());
            }
            for fit in crate::compare(&estimated.model, &data).unwrap() {
                assert!(fit.unwrap().fit_percent.unwrap() > 100.0 - 1e-7, "{fit:?}");
            }
            assert!(matches!(subspace.realize(4).unwrap_err(), IdentifyError::OrderTooHigh { highest: 3, .. }));
        }
    }
}

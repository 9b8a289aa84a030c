//! A model realised from Markov parameters, and the evidence for it.

use crumple_metrics::fit_percent;
use crumple_numerics::linalg::TriangularFactor;
use crumple_numerics::lti::{Complex, LtiError, StateSpace, undo_zero_order_hold};
use nalgebra::DMatrix;

use crate::EraError;
use crate::data::{MarkovParameters, markov_parameters};
use crate::hankel::singular_value_gap::GapOrder;
use crate::hankel::svd::Decomposition;
use crate::modes::{IdentifiedMode, modes, normalized};
use crate::simulation::fit::{common_fit_percent, common_rmse};

/// A model realised from a record, with the evidence for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Realization {
    /// Sampled model, balanced: `|b| = |c|` for a symmetric Hankel matrix. `d` is the first sample.
    pub discrete: StateSpace,
    /// The continuous model that it samples with a zero-order hold; or why there is none (a negative real pole has no
    /// continuous counterpart: the order is too high, or the record is noise).
    pub continuous: Result<StateSpace, LtiError>,
    /// Poles sorted by `|Im|`, then `Re`, with their evidence.
    pub modes: Vec<IdentifiedMode>,
    /// Shape of each mode: what every output shows of it, the largest entry 1; `None` if the model has multiple poles.
    pub mode_shapes: Vec<Option<Vec<Complex>>>,
    /// Leading singular values of `H0`, largest first. More exist unless the decomposition was dense.
    pub singular_values: Vec<f64>,
    /// Bound of the error of each: rounding for those that converged, up to 3 % of themselves for the last.
    pub singular_value_errors: Vec<f64>,
    /// How they were computed.
    pub decomposition: Decomposition,
    /// Rows of the Hankel matrix.
    pub rows: usize,
    /// Its columns.
    pub columns: usize,
    /// Fit of the impulse response to all samples of all sequences; `None` for constant records or an overflowing
    /// response.
    pub fit_percent: Option<f64>,
    /// The same for every sequence alone.
    pub sequence_fits_percent: Vec<Option<f64>>,
    /// Root mean square error of the impulse response, unit of the record; `None` if it overflows.
    pub rmse: Option<f64>,
    /// Where the order came from; `None`: it was given.
    pub chosen: Option<GapOrder>,
}

impl Realization {
    /// Number of states.
    pub fn order(&self) -> usize {
        self.discrete.order()
    }

    /// The same model of outputs in other units: each times its factor. Singular values stay those of the sequences
    /// that were decomposed; there is no common root mean square error.
    pub fn with_outputs_times(mut self, factors: &[f64]) -> Self {
        let scale = |model: &mut StateSpace| {
            for (i, factor) in factors.iter().enumerate().take(model.c.nrows()) {
                model.c.row_mut(i).scale_mut(*factor);
                model.d.row_mut(i).scale_mut(*factor);
            }
        };
        scale(&mut self.discrete);
        if let Ok(continuous) = &mut self.continuous {
            scale(continuous);
        }
        for shape in &mut self.mode_shapes {
            let entries = shape.take();
            *shape = entries.and_then(|s| normalized(s.iter().zip(factors).map(|(x, factor)| x * *factor).collect()));
        }
        self.rmse = None;
        self
    }
}

/// What a decomposition knows before there is a model.
pub(crate) struct Known {
    /// With bounds of their errors.
    pub(crate) singular_values: Vec<(f64, f64)>,
    pub(crate) decomposition: Decomposition,
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    pub(crate) chosen: Option<GapOrder>,
}

/// Analyses a realised model: modes with their evidence, the continuous model, the fit to the parameters it came from.
///
/// `controllability` is the identified sequence `[B, A B, ...]`, states x columns, `terms` the samples that a mode's
/// singular value sums over. Errors: eigenvalues that do not converge, a matrix that is not finite.
pub(crate) fn realization(
    discrete: StateSpace,
    markov: &MarkovParameters<'_>,
    controllability: &DMatrix<f64>,
    terms: usize,
    known: Known,
) -> Result<Realization, EraError> {
    let poles = discrete.poles()?;
    let dt = discrete.sample_time_s.unwrap_or(1.0);
    let (modes, mode_shapes) = modes(&discrete, &poles, dt, controllability, terms);
    let response = markov_parameters(&discrete, markov.samples());
    let pairs: Vec<(&[f64], &[f64])> =
        markov.sequences().iter().zip(&response).map(|(y, model)| (*y, model.as_slice())).collect();
    let (singular_values, singular_value_errors) = known.singular_values.into_iter().unzip();
    Ok(Realization {
        continuous: undo_zero_order_hold(&discrete),
        modes,
        mode_shapes,
        singular_values,
        singular_value_errors,
        decomposition: known.decomposition,
        rows: known.rows,
        columns: known.columns,
        fit_percent: common_fit_percent(&pairs),
        sequence_fits_percent: pairs.iter().map(|(y, model)| fit_percent(y, model)).collect(),
        rmse: common_rmse(&pairs),
        chosen: known.chosen,
        discrete,
    })
}

/// Directions of the state that the parameters show with less than this fraction of the strongest are left at zero.
const TRUNCATION: f64 = 1e-12;

/// `B` such that `C A^k B` fits `parameters[i][j][k]`, output `i` to input `j`, best in the sense of least squares. The
/// caller sees to it that `A` does not grow beyond bounds over as many samples. `None` if the fit does not settle.
///
/// One equation per output and sample, `C A^k b_j = h_ij[k]`, all inputs as right-hand sides of one factorisation.
/// `a` is `n x n`, `c` is `outputs x n`, the result `n x inputs`, in the unit of the parameters over that of `c`.
pub(crate) fn input_matrix_of(a: &DMatrix<f64>, c: &DMatrix<f64>, parameters: &[Vec<&[f64]>]) -> Option<DMatrix<f64>> {
    let (n, q) = (a.nrows(), parameters.len());
    let (m, samples) = (parameters.first()?.len(), parameters.first()?.first()?.len());
    let mut factor = TriangularFactor::new(n + m);
    let block = TriangularFactor::block_rows(n + m).div_ceil(q);
    let mut free = c.clone();
    let mut next = free.clone();
    for start in (0..samples).step_by(block) {
        let count = block.min(samples - start);
        let rows = count * q;
        let mut data = vec![0.0; rows * (n + m)];
        for k in 0..count {
            for i in 0..q {
                for s in 0..n {
                    data[s * rows + k * q + i] = free[(i, s)];
                }
                for j in 0..m {
                    data[(n + j) * rows + k * q + i] = parameters[i][j][start + k];
                }
            }
            free.mul_to(a, &mut next);
            std::mem::swap(&mut free, &mut next);
        }
        factor.push(rows, &mut data);
    }
    Some(factor.solve(m, TRUNCATION)?.coefficients)
}

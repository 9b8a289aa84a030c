//! The eigensystem realization algorithm with data correlations (ERA/DC).

use crumple_numerics::linalg::jacobi_svd;
use crumple_numerics::lti::{LtiError, StateSpace};
use nalgebra::{DMatrix, DVector};

use crate::era::era::{decompose, shape};
use crate::era::realization::input_matrix_of;
use crate::era::realization::{Known, realization};
use crate::era::shift_form::state_matrix;
use crate::hankel::correlations::{CorrelationSize, Correlations};
use crate::hankel::shift_pair::{Shift, ShiftPair};
use crate::hankel::singular_value_gap::order_by_gap;
use crate::hankel::svd::Factors;
use crate::simulation::input_matrices::grows;
use crate::{EraError, EraOptions, MarkovParameters, Order, Realization};

/// Settings of [`EraDc`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EraDcOptions {
    /// Settings shared with [`Era`](crate::Era). `rows` are those of the Hankel matrices that are correlated, `columns`
    /// what the correlations sum over: by default half each of what the lags leave of the record, as in ERA. In noise
    /// fewer rows lose much and more columns gain nothing (50 rows of 500 to 3000: two to five times the pole error).
    pub era: EraOptions,
    /// Lag of the first correlation, samples. 0: none is left out. From `rows` on no correlation has white noise in it,
    /// at the price of a decayed signal.
    pub offset: usize,
    /// Correlations stacked beyond the first, each way.
    pub lag_blocks: usize,
}

impl EraDcOptions {
    /// Order by the gap rule up to 20, no offset, 10 lag blocks.
    pub fn new(sample_time_s: f64) -> Self {
        Self { era: EraOptions::new(sample_time_s), offset: 0, lag_blocks: 10 }
    }
}

/// A record's correlations, decomposed, from which models of several orders follow at little cost.
///
/// `Hc(k) = H_k H_0'` holds correlations of the record with itself, averaged over the columns; noise that is white has
/// none but where the lag is zero. They follow the same recursion as the Markov parameters, so that ERA on the block
/// Hankel matrix of `Hc(offset), Hc(offset + 1), ...` gives `A` and `C`. `B` is then found by least squares on all
/// Markov parameters, in which it is linear (Juang's `pinv(O) H0` uses the first rows only).
///
/// Without lag blocks and offset the poles are those of ERA with the same rows and columns. Singular values are those
/// of ERA squared: a mode that is seen with less than 1e-6 of the first is lost in rounding, where ERA sees 1e-12.
///
/// Juang, Cooper & Wright, "An eigensystem realization algorithm using data correlations (ERA/DC) for modal parameter
/// identification", Control-Theory and Advanced Technology 4(1), 1988.
pub struct EraDc<'a> {
    markov: MarkovParameters<'a>,
    options: EraDcOptions,
    size: CorrelationSize,
    /// The sequences after the direct term, divided by `scale`: `B` is fitted to them.
    scaled: Vec<Vec<f64>>,
    /// Power of two by which the samples were divided.
    scale: f64,
    factors: Factors,
    /// `U' H1 V` of the correlations, as in [`Era`](crate::Era).
    shifted: DMatrix<f64>,
}

impl<'a> EraDc<'a> {
    /// Decomposes the correlations for the orders to come; `options.era.order` is not looked at.
    ///
    /// Errors: too few samples for rows, columns and lags together, silence, a decomposition that does not converge.
    pub fn from_markov(
        markov: MarkovParameters<'a>,
        options: EraDcOptions,
        orders: &[Order],
    ) -> Result<Self, EraError> {
        let opt = options.era;
        if !(opt.sample_time_s.is_finite() && opt.sample_time_s > 0.0) {
            return Err(LtiError::SampleTime(opt.sample_time_s).into());
        }
        let parameters = markov.samples().saturating_sub(1);
        let lags = options.lag_blocks.saturating_mul(2).saturating_add(options.offset);
        let (rows, columns) = shape(parameters.saturating_sub(lags), opt.rows, opt.columns);
        let size = CorrelationSize { rows, columns, offset: options.offset, lag_blocks: options.lag_blocks };
        let needed = size.parameters();
        if rows == 0 || columns == 0 || needed > parameters {
            return Err(EraError::TooShortForCorrelations { parameters, rows, columns, lags });
        }
        let used = || markov.sequences().iter().map(|y| &y[1..=needed]);
        let largest = used().flatten().fold(0.0_f64, |m, y| m.max(y.abs()));
        if used().all(|y| y[..rows + columns - 1].iter().all(|y| *y == 0.0)) {
            return Err(EraError::Silent { samples: needed });
        }
        let scale = largest.log2().floor().exp2().max(f64::MIN_POSITIVE);
        let scaled: Vec<Vec<f64>> = used().map(|y| y.iter().map(|y| y / scale).collect()).collect();
        let given = orders.iter().map(|order| if let Order::Given(n) = order { *n } else { 0 }).max().unwrap_or(0);
        let automatic = orders.contains(&Order::Automatic);
        let mut pair = Correlations::new(&slices(&scaled), markov.inputs(), size);
        let (factors, shifted) = decompose(&mut pair, given, automatic.then_some(opt.max_order))?;
        Ok(Self { markov, options, size, scale, factors, shifted, scaled })
    }

    /// Number of singular values above rounding: the highest order the correlations support.
    pub fn rank(&self) -> usize {
        self.factors.rank()
    }

    /// Builds the model of one of the orders that [`EraDc::from_markov`] was given.
    ///
    /// With `Hc = U S V'` the balanced coordinates of ERA are `U S^1/4`: correlations are squares of the record, so
    /// that the fourth root of their singular values stands where ERA has the square root.
    pub fn realize(&self, order: Order) -> Result<Realization, EraError> {
        let opt = self.options.era;
        let (n, chosen) = match order {
            Order::Given(n) => (n, None),
            Order::Automatic => {
                let gap = order_by_gap(&self.factors.values, opt.max_order);
                (gap.map_or(1, |gap| gap.order), gap)
            }
        };
        let (q, m) = (self.markov.outputs(), self.markov.inputs());
        let CorrelationSize { rows, columns, lag_blocks, .. } = self.size;
        let total = rows * q * (lag_blocks + 1);
        if n == 0 {
            return Err(EraError::OrderZero);
        }
        if n > total {
            return Err(EraError::OrderAboveSize { order: n, rows: total, columns: total });
        }
        if n > self.rank() {
            return Err(EraError::OrderAboveRank { order: n, rank: self.rank() });
        }
        if n > self.shifted.ncols() {
            return Err(EraError::NotConverged { rows: total, columns: total, steps: self.shifted.ncols() });
        }
        let left = self.factors.left.columns(0, n).into_owned();
        let values = &self.factors.values[..n];
        let roots = DVector::from_iterator(n, values.iter().map(|s| s.sqrt()));
        // The stack repeats itself within a block: only from block to block is it one sample later throughout.
        let step = if lag_blocks > 0 { rows * q } else { q };
        let form = opt.shift;
        let failed = || EraError::NoShift { order: n, form: form.name() };
        let stacked = state_matrix(form, &left, &roots, &self.shifted, step).ok_or_else(failed)?;
        // Correlations are squares: fourth roots of their singular values give the coordinates of ERA.
        let balance: Vec<f64> = roots.iter().map(|r| r.sqrt()).collect();
        let a = DMatrix::from_fn(n, n, |i, j| balance[i] * stacked[(i, j)] / balance[j]);
        let observability = DMatrix::from_fn(rows * q, n, |i, j| left[(i, j)] * balance[j]);
        let c = observability.rows(0, q).into_owned();

        // A model that grows beyond bounds is fitted where it was found.
        let samples = self.scaled[0].len();
        let samples = if grows(&a, samples) { rows } else { samples };
        let parameters: Vec<Vec<&[f64]>> =
            (0..q).map(|i| (0..m).map(|j| &self.scaled[i * m + j][..samples]).collect()).collect();
        let b = input_matrix_of(&a, &c, &parameters).ok_or_else(failed)?;
        let controllability = self.controllability(&observability).ok_or_else(failed)?;
        let root = self.scale.sqrt();
        let d = DMatrix::from_fn(q, m, |i, j| self.markov.sequence(i, j)[0]);
        let discrete = StateSpace::new(a, b * root, c * root, d, Some(opt.sample_time_s))?;
        let square = self.scale * self.scale;
        realization(
            discrete,
            &self.markov,
            &controllability,
            rows + columns,
            Known {
                singular_values: self.factors.seen.iter().map(|(s, error)| (s * square, error * square)).collect(),
                decomposition: self.factors.decomposition,
                rows,
                columns,
                chosen,
            },
        )
    }

    /// `pinv(O) H_0`: the identified sequence `[B, A B, ...]` that the coherence compares with, up to a factor.
    fn controllability(&self, observability: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let n = observability.ncols();
        // Fewer rows than states: the block is padded, which changes no column.
        let padded = observability.clone().resize_vertically(observability.nrows().max(n), 0.0);
        let svd = jacobi_svd(&padded)?;
        let tolerance = 1e-12 * svd.values.first().copied().unwrap_or(0.0);
        let mut left = svd.left;
        for (mut column, s) in left.column_iter_mut().zip(&svd.values) {
            column *= if *s > tolerance { 1.0 / s } else { 0.0 };
        }
        let inverse = svd.right * left.transpose();
        let mut pair = Correlations::new(&slices(&self.scaled), self.markov.inputs(), self.size);
        let h0 = pair.first();
        let mut product = DMatrix::zeros(n, h0.columns());
        let mut row = vec![0.0; h0.columns()];
        for i in 0..n {
            let weights: Vec<f64> = inverse.row(i).iter().take(h0.rows()).copied().collect();
            h0.multiply_transposed(Shift::Zero, &weights, &mut row);
            for (target, value) in product.row_mut(i).iter_mut().zip(&row) {
                *target = *value;
            }
        }
        Some(product)
    }
}

fn slices(sequences: &[Vec<f64>]) -> Vec<&[f64]> {
    sequences.iter().map(Vec::as_slice).collect()
}

/// The same as [`EraDc`] in one call, for one channel.
pub fn era_dc(markov: &[f64], options: EraDcOptions) -> Result<Realization, EraError> {
    let order = options.era.order;
    EraDc::from_markov(MarkovParameters::new(vec![markov], 1)?, options, &[order])?.realize(order)
}

//! The eigensystem realization algorithm for one channel.

use crumple_lti::{LtiError, StateSpace, impulse_response, undo_zero_order_hold};
use crumple_metrics::{fit_percent, rmse};
use nalgebra::{DMatrix, DVector};

use crate::factors::{Decomposition, Factors, RANK_TOLERANCE, factorize};
use crate::hankel::{Hankel, Shift};
use crate::modal::{IdentifiedMode, modes};
use crate::order::{GapOrder, order_by_gap};

/// Singular values one likes to see beyond the highest order: the gap after it, and some of what follows.
const VALUES_BEYOND: usize = 8;

/// Number of states of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// As given.
    Given(usize),
    /// By the largest gap between singular values, see [`order_by_gap`].
    Automatic,
}

/// Settings of [`era`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EraOptions {
    /// Sampling interval, s.
    pub sample_time_s: f64,
    /// Number of states.
    pub order: Order,
    /// Highest order that [`Order::Automatic`] considers.
    pub max_order: usize,
    /// Rows of the Hankel matrix; `None`: half of the record, or what `columns` leaves of it.
    pub rows: Option<usize>,
    /// Columns of the Hankel matrix; `None`: half of the record, or what `rows` leaves of it.
    pub columns: Option<usize>,
}

impl EraOptions {
    /// Whole record, order by the gap rule up to 20.
    pub fn new(sample_time_s: f64) -> Self {
        Self { sample_time_s, order: Order::Automatic, max_order: 20, rows: None, columns: None }
    }
}

/// Why there is no model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EraError {
    /// A sample is NaN or infinite.
    #[error("sample {index} is not a finite number")]
    NotFinite {
        /// Its index.
        index: usize,
    },
    /// Everything after the first sample is zero.
    #[error("all {samples} samples after the first are zero: there is no motion to identify")]
    Silent {
        /// How many.
        samples: usize,
    },
    /// Fewer Markov parameters than the Hankel pair holds.
    #[error("{parameters} Markov parameters, but a {rows}x{columns} Hankel pair needs {}", rows + columns)]
    TooShort {
        /// Samples after the first.
        parameters: usize,
        /// Rows of the Hankel matrix.
        rows: usize,
        /// Columns.
        columns: usize,
    },
    /// More states than rows or columns.
    #[error("order {order} needs at least {order} rows and columns, the Hankel matrix is {rows}x{columns}")]
    OrderAboveSize {
        /// The order asked for.
        order: usize,
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
    },
    /// More states than the record shows.
    #[error("order {order} exceeds the numerical rank {rank} (σ[{rank}]/σ[0] < {RANK_TOLERANCE:.0e})")]
    OrderAboveRank {
        /// The order asked for.
        order: usize,
        /// Number of singular values above rounding.
        rank: usize,
    },
    /// A model without states.
    #[error("order 0 is no model")]
    OrderZero,
    /// The singular value decomposition did not settle.
    #[error(
        "the singular values of the {rows}x{columns} Hankel matrix did not converge in {steps} steps; use a lower order, or fewer rows and columns"
    )]
    NotConverged {
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
        /// Steps taken.
        steps: usize,
    },
    /// The realised matrices cannot be analysed.
    #[error(transparent)]
    System(#[from] LtiError),
}

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
    /// Fit of the impulse response to all samples; `None` for a constant record or an overflowing response.
    pub fit_percent: Option<f64>,
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
}

/// Realizes a discrete-time model from one channel's Markov parameters.
///
/// `markov[0]` is the direct term `D`, `markov[k]` is `C A^(k-1) B`, k = 1, 2, ... `H0[i,j] = markov[i+j+1]` is `rows
/// x columns` and `H1` its shift, so `rows + columns` parameters after the first are used. With `H0 ≈ U S V'` cut to
/// the order, `A = S^-1/2 U' H1 V S^-1/2`, `B = S^1/2 V' e1`, `C = e1' U S^1/2`. (Equation 62 of the crash paper
/// prints `S^-1/2` in `B` and `C`, which does not reproduce the parameters.) Poles do not depend on the scale of
/// `markov`.
///
/// Exact, to rounding, for a record that is the impulse response of a system of that order. In noise poles are biased
/// towards damping, the less the longer the record. A window much shorter than a period gives meaningless, even
/// unstable poles.
///
/// Juang & Pappa, "An eigensystem realization algorithm for modal parameter identification and model reduction", J.
/// Guidance 8(5), 1985.
pub fn era(markov: &[f64], opt: EraOptions) -> Result<Realization, EraError> {
    Era::new(markov, opt, &[opt.order])?.realize(opt.order)
}

/// A decomposed record, from which models of several orders follow at little cost.
pub struct Era<'a> {
    markov: &'a [f64],
    opt: EraOptions,
    rows: usize,
    columns: usize,
    /// Power of two by which the samples were divided.
    scale: f64,
    factors: Factors,
    /// `U' H1 V` for as many triplets as were computed.
    shifted: DMatrix<f64>,
}

impl<'a> Era<'a> {
    /// Decomposes the Hankel matrix for the orders to come; `opt.order` is not looked at.
    pub fn new(markov: &'a [f64], opt: EraOptions, orders: &[Order]) -> Result<Self, EraError> {
        if !(opt.sample_time_s.is_finite() && opt.sample_time_s > 0.0) {
            return Err(LtiError::SampleTime(opt.sample_time_s).into());
        }
        if let Some(index) = markov.iter().position(|y| !y.is_finite()) {
            return Err(EraError::NotFinite { index });
        }
        let parameters = markov.len().saturating_sub(1);
        let (rows, columns) = shape(parameters, opt.rows, opt.columns);
        if rows == 0 || columns == 0 || rows.saturating_add(columns) > parameters {
            return Err(EraError::TooShort { parameters, rows: rows.max(1), columns: columns.max(1) });
        }
        let used = &markov[1..=rows + columns];
        let largest = used.iter().fold(0.0_f64, |m, y| m.max(y.abs()));
        // The last parameter stands in the shifted matrix only: without any other there is nothing to decompose.
        if used[..used.len() - 1].iter().all(|y| *y == 0.0) {
            return Err(EraError::Silent { samples: used.len() });
        }
        // Scaling by a power of two rounds nothing and keeps squares inside the range of f64.
        let scale = largest.log2().floor().exp2().max(f64::MIN_POSITIVE);
        let scaled: Vec<f64> = used.iter().map(|y| y / scale).collect();

        let size = rows.min(columns);
        let given = orders.iter().map(|order| if let Order::Given(n) = order { *n } else { 0 }).max().unwrap_or(0);
        let automatic = orders.contains(&Order::Automatic);
        let highest = if automatic { given.max(opt.max_order) } else { given };
        let mut hankel = Hankel::new(&scaled, rows, columns);
        let factors = factorize(&mut hankel, (highest + VALUES_BEYOND).min(size), automatic, |values| {
            let chosen = if automatic { order_by_gap(values, opt.max_order).map_or(0, |gap| gap.order) } else { 0 };
            given.max(chosen).min(size)
        })?;

        let count = factors.left.ncols().min(factors.right.ncols()).min(factors.rank()).min(highest.max(1));
        let mut products = DMatrix::zeros(rows, count);
        let mut product = vec![0.0; rows];
        for i in 0..count {
            hankel.multiply(Shift::One, factors.right.column(i).as_slice(), &mut product);
            products.column_mut(i).copy_from_slice(&product);
        }
        let shifted = factors.left.columns(0, count).tr_mul(&products);
        Ok(Self { markov, opt, rows, columns, scale, factors, shifted })
    }

    /// Number of singular values above rounding: the highest order the record supports.
    pub fn rank(&self) -> usize {
        self.factors.rank()
    }

    /// The order by the gap rule and its evidence; `None` for a matrix of one row or column.
    pub fn gap(&self) -> Option<GapOrder> {
        order_by_gap(&self.factors.values, self.opt.max_order)
            .map(|gap| GapOrder { noise_level: gap.noise_level.map(|s| s * self.scale), ..gap })
    }

    /// Builds the model of one of the orders that [`Era::new`] was given.
    pub fn realize(&self, order: Order) -> Result<Realization, EraError> {
        let (n, chosen) = match order {
            Order::Given(n) => (n, None),
            Order::Automatic => {
                let gap = self.gap();
                (gap.map_or(1, |gap| gap.order), gap)
            }
        };
        let (rows, columns) = (self.rows, self.columns);
        if n == 0 {
            return Err(EraError::OrderZero);
        }
        if n > rows.min(columns) {
            return Err(EraError::OrderAboveSize { order: n, rows, columns });
        }
        if n > self.rank() {
            return Err(EraError::OrderAboveRank { order: n, rank: self.rank() });
        }
        if n > self.shifted.ncols() {
            return Err(EraError::NotConverged { rows, columns, steps: self.shifted.ncols() });
        }

        let roots = DVector::from_iterator(n, self.factors.values[..n].iter().map(|s| s.sqrt()));
        let a = DMatrix::from_fn(n, n, |i, j| self.shifted[(i, j)] / (roots[i] * roots[j]));
        let controllability =
            DMatrix::from_fn(n, columns, |i, j| roots[i] * self.factors.right[(j, i)]) * self.scale.sqrt();
        let b = controllability.columns(0, 1).into_owned();
        let c = DMatrix::from_fn(1, n, |_, i| roots[i] * self.factors.left[(0, i)]) * self.scale.sqrt();
        let d = DMatrix::from_element(1, 1, self.markov[0]);
        let dt = self.opt.sample_time_s;
        let discrete = StateSpace::new(a, b, c, d, Some(dt))?;

        let poles = discrete.poles()?;
        let response = impulse_response(&discrete, self.markov.len())?;
        Ok(Realization {
            continuous: undo_zero_order_hold(&discrete),
            modes: modes(&discrete, &poles, dt, &controllability, rows + columns),
            singular_values: self.factors.seen.iter().map(|(s, _)| s * self.scale).collect(),
            singular_value_errors: self.factors.seen.iter().map(|(_, error)| error * self.scale).collect(),
            decomposition: self.factors.decomposition,
            rows,
            columns,
            fit_percent: fit_percent(self.markov, &response),
            rmse: rmse(self.markov, &response),
            chosen,
            discrete,
        })
    }
}

/// Rows and columns: as given, else half of the parameters each; an odd one is left out, for a square matrix is
/// symmetric.
fn shape(parameters: usize, rows: Option<usize>, columns: Option<usize>) -> (usize, usize) {
    match (rows, columns) {
        (Some(rows), Some(columns)) => (rows, columns),
        (Some(rows), None) => (rows, parameters.saturating_sub(rows)),
        (None, Some(columns)) => (parameters.saturating_sub(columns), columns),
        (None, None) => (parameters / 2, parameters / 2),
    }
}

//! The eigensystem realization algorithm.

use crumple_numerics::lti::{LtiError, StateSpace};
use nalgebra::{DMatrix, DVector};

use crate::EraError;
use crate::data::MarkovParameters;
use crate::era::realization::{Known, Realization, realization};
use crate::hankel::block_hankel::Hankel;
use crate::hankel::shift_pair::{Shift, ShiftPair};
use crate::hankel::singular_value_gap::{GapOrder, order_by_gap};
use crate::hankel::svd::{Factors, factorize};

/// Singular values one likes to see beyond the highest order: the gap after it, and some of what follows.
const VALUES_BEYOND: usize = 8;

/// Number of states of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// As given.
    Given(usize),
    /// By the largest gap between singular values, see [`GapOrder`].
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
    /// Block rows of the Hankel matrix; `None`: half of the record, or what `columns` leaves of it.
    pub rows: Option<usize>,
    /// Block columns of the Hankel matrix; `None`: half of the record, or what `rows` leaves of it.
    pub columns: Option<usize>,
}

impl EraOptions {
    /// Whole record, order by the gap rule up to 20.
    pub fn new(sample_time_s: f64) -> Self {
        Self { sample_time_s, order: Order::Automatic, max_order: 20, rows: None, columns: None }
    }

    /// The same with a Hankel matrix of `2 order` rows and columns, the size other toolboxes start from
    /// (python-control, ControlSystemIdentification.jl). It uses the first `4 order` samples alone: quick, and poor in
    /// noise.
    pub fn twice_the_order(self, order: usize) -> Self {
        let size = Some(order.saturating_mul(2));
        Self { order: Order::Given(order), rows: size, columns: size, ..self }
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
    markov: MarkovParameters<'a>,
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
    /// Decomposes the Hankel matrix of one channel for the orders to come; `opt.order` is not looked at.
    pub fn new(markov: &'a [f64], opt: EraOptions, orders: &[Order]) -> Result<Self, EraError> {
        Self::from_markov(MarkovParameters::new(vec![markov], 1)?, opt, orders)
    }

    /// The same for any number of outputs and inputs, with a block Hankel matrix. Sequences count by their size: bring
    /// them to comparable ones first where they measure different things.
    pub fn from_markov(markov: MarkovParameters<'a>, opt: EraOptions, orders: &[Order]) -> Result<Self, EraError> {
        if !(opt.sample_time_s.is_finite() && opt.sample_time_s > 0.0) {
            return Err(LtiError::SampleTime(opt.sample_time_s).into());
        }
        let parameters = markov.samples().saturating_sub(1);
        let (rows, columns) = shape(parameters, opt.rows, opt.columns);
        if rows == 0 || columns == 0 || rows.saturating_add(columns) > parameters {
            return Err(EraError::TooShort { parameters, rows: rows.max(1), columns: columns.max(1) });
        }
        let used = || markov.sequences().iter().map(|y| &y[1..=rows + columns]);
        let largest = used().flatten().fold(0.0_f64, |m, y| m.max(y.abs()));
        // The last parameter stands in the shifted matrix only: without any other there is nothing to decompose.
        if used().all(|y| y[..y.len() - 1].iter().all(|y| *y == 0.0)) {
            return Err(EraError::Silent { samples: rows + columns });
        }
        // Scaling by a power of two rounds nothing and keeps squares inside the range of f64.
        let scale = largest.log2().floor().exp2().max(f64::MIN_POSITIVE);
        let scaled: Vec<Vec<f64>> = used().map(|y| y.iter().map(|y| y / scale).collect()).collect();

        let mut hankel = Hankel::new(scaled.iter().map(Vec::as_slice).collect(), markov.inputs(), rows, columns);
        let given = orders.iter().map(|order| if let Order::Given(n) = order { *n } else { 0 }).max().unwrap_or(0);
        let automatic = orders.contains(&Order::Automatic);
        let (factors, shifted) = decompose(&mut hankel, given, automatic.then_some(opt.max_order))?;
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
        let (q, m) = (self.markov.outputs(), self.markov.inputs());
        let (rows, columns) = (self.rows * q, self.columns * m);
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
        let left = self.factors.left.columns(0, n).into_owned();
        let a = DMatrix::from_fn(n, n, |i, j| self.shifted[(i, j)] / (roots[i] * roots[j]));
        let controllability =
            DMatrix::from_fn(n, columns, |i, j| roots[i] * self.factors.right[(j, i)]) * self.scale.sqrt();
        let b = controllability.columns(0, m).into_owned();
        let c = DMatrix::from_fn(q, n, |r, i| roots[i] * left[(r, i)]) * self.scale.sqrt();
        let d = DMatrix::from_fn(q, m, |i, j| self.markov.sequence(i, j)[0]);
        let dt = self.opt.sample_time_s;
        let discrete = StateSpace::new(a, b, c, d, Some(dt))?;
        realization(
            discrete,
            &self.markov,
            &controllability,
            self.rows + self.columns,
            Known {
                singular_values: self
                    .factors
                    .seen
                    .iter()
                    .map(|(s, error)| (s * self.scale, error * self.scale))
                    .collect(),
                decomposition: self.factors.decomposition,
                rows: self.rows,
                columns: self.columns,
                chosen,
            },
        )
    }
}

/// Leading singular triplets of the first of the pair, and `U' H1 V`: for orders up to `given`, and up to the order by
/// the gap rule if a highest order for that is stated.
fn decompose(
    pair: &mut impl ShiftPair,
    given: usize,
    max_order: Option<usize>,
) -> Result<(Factors, DMatrix<f64>), EraError> {
    let size = pair.rows().min(pair.columns());
    let highest = given.max(max_order.unwrap_or(0));
    let factors = factorize(pair, (highest + VALUES_BEYOND).min(size), max_order.is_some(), |values| {
        let chosen = max_order.and_then(|highest| order_by_gap(values, highest)).map_or(0, |gap| gap.order);
        given.max(chosen).min(size)
    })?;
    let count = factors.left.ncols().min(factors.right.ncols()).min(factors.rank()).min(highest.max(1));
    let mut products = DMatrix::zeros(pair.rows(), count);
    let mut product = vec![0.0; pair.rows()];
    for i in 0..count {
        pair.multiply(Shift::One, factors.right.column(i).as_slice(), &mut product);
        products.column_mut(i).copy_from_slice(&product);
    }
    let shifted = factors.left.columns(0, count).tr_mul(&products);
    Ok((factors, shifted))
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

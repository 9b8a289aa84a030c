//! Why an estimator gives no model.

use crumple_numerics::lti::LtiError;

/// Singular values below this fraction of the largest are rounding.
pub(crate) const RANK_TOLERANCE: f64 = 1e-12;

/// Why there is no model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EraError {
    /// Sequences that do not pair outputs with inputs.
    #[error("{sequences} sequences of Markov parameters are not those of {inputs} inputs")]
    Sequences {
        /// How many.
        sequences: usize,
        /// Number of inputs.
        inputs: usize,
    },
    /// Sequences of different lengths.
    #[error("sequence {} has {found} samples, the first has {expected}", number + 1)]
    Lengths {
        /// Which, from 0.
        number: usize,
        /// Its length.
        found: usize,
        /// Length of the first.
        expected: usize,
    },
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
        "the singular values of the {rows}x{columns} Hankel matrix did not converge in {steps} steps; use a lower \
         order, or fewer rows and columns"
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

// Why an estimator between inputs and outputs gives no model.

/// Why an estimator gives no model. ([`EraError`](crate::EraError) is that of the Hankel methods.)
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// Nothing to explain.
    #[error("there is no output, or it has no samples")]
    NoOutput,
    /// Signals of different lengths.
    #[error("{kind} {} has {found} samples, the first output has {expected}", number + 1)]
    Lengths {
        /// `input` or `output`.
        kind: &'static str,
        /// Which, from 0.
        number: usize,
        /// Its length.
        found: usize,
        /// Length of the first output.
        expected: usize,
    },
    /// A sample is NaN or infinite.
    #[error("sample {index} of {kind} {} is not a finite number", number + 1)]
    NotFinite {
        /// `input` or `output`.
        kind: &'static str,
        /// Which, from 0.
        number: usize,
        /// Index of the sample.
        index: usize,
    },
    /// Fewer samples than the method needs.
    #[error("{samples} samples, {method} needs {needed} ({why})")]
    TooShort {
        /// The method.
        method: &'static str,
        /// What there is.
        samples: usize,
        /// What is needed.
        needed: usize,
        /// By which count.
        why: String,
    },
    /// A signal that is zero throughout.
    #[error("every sample of the {0} is zero: there is nothing to identify")]
    Silent(&'static str),
    /// A model without states or parameters.
    #[error("order 0 is no model")]
    OrderZero,
    /// More states than the factorisation supports.
    #[error("order {order} exceeds what {method} can realise here, {highest} states")]
    OrderTooHigh {
        /// The method.
        method: &'static str,
        /// The order asked for.
        order: usize,
        /// The highest possible.
        highest: usize,
    },
    /// A method for other numbers of inputs and outputs.
    #[error("{method} works on {needed}, the data have {inputs} inputs and {outputs} outputs")]
    Channels {
        /// The method.
        method: &'static str,
        /// What it takes.
        needed: &'static str,
        /// Number of inputs.
        inputs: usize,
        /// Number of outputs.
        outputs: usize,
    },
    /// A least-squares problem without a determined solution.
    #[error(
        "the equations of {method} have condition number {condition:.1e}, above {limit:.0e}: the data do not determine \
         the model"
    )]
    IllConditioned {
        /// The method.
        method: &'static str,
        /// Condition number of the column-scaled equations.
        condition: f64,
        /// The limit.
        limit: f64,
    },
    /// More zeros than poles.
    #[error("{zeros} zeros and {poles} poles: a transfer function that can be simulated has no more zeros than poles")]
    NotProper {
        /// Number of zeros.
        zeros: usize,
        /// Number of poles.
        poles: usize,
    },
    /// More conditions at the start than the terms can meet.
    #[error("{conditions} conditions at the start, a sum of {terms} exponentials can meet {terms} at most")]
    Conditions {
        /// Number of conditions.
        conditions: usize,
        /// Number of terms.
        terms: usize,
    },
    /// No starting point gave a finite response.
    #[error("none of the {starts} starting points of {method} gave a finite response")]
    NoStart {
        /// The method.
        method: &'static str,
        /// How many were tried.
        starts: usize,
    },
    /// The identified observer is unstable, so its Markov parameters grow.
    #[error(
        "okid_diverged: the Markov parameters grow by a factor {growth:.1e} beyond the {lags} lags; take more lags or \
         a subspace method"
    )]
    Diverged {
        /// Largest of the last Markov parameters over the largest within the lags.
        growth: f64,
        /// Number of lags.
        lags: usize,
    },
    /// A model that follows the record worse than its mean does by far.
    #[error(
        "the simulation does not follow the record (fit {fit_percent:.3e} %, {limit} % is the least accepted): \
        {why}"
    )]
    Misses {
        /// Fit of the simulated output with the best initial state; of several the smallest.
        fit_percent: f64,
        /// The least that is accepted.
        limit: f64,
        /// What is known of the model, e.g. its fastest growth.
        why: MissReason,
    },
    /// The Hankel matrix of estimated Markov parameters gives no model.
    #[error(transparent)]
    Hankel(#[from] EraError),
    /// A decomposition did not settle.
    #[error("{0} did not converge")]
    NotConverged(&'static str),
    /// A system that cannot be analysed.
    #[error(transparent)]
    System(#[from] LtiError),
}

/// What is known of a model that misses the record by far.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MissReason {
    /// A pole lies outside the unit circle.
    #[error("a pole of the model is unstable: it grows by a factor {factor:.6} per sample")]
    Grows {
        /// Its modulus.
        factor: f64,
    },
    /// A pole lies on the unit circle: it neither grows nor dies down over the record.
    #[error("a pole of the model is marginal, on the unit circle")]
    Marginal,
    /// Every pole dies down.
    #[error("all poles of the model are stable")]
    Stable,
}

//! Why ERA has no model.

use crumple_lti::LtiError;

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
    /// Fewer Markov parameters than the correlations take.
    #[error(
        "{parameters} Markov parameters, but correlations of {rows}x{columns} Hankel matrices over {lags} lags need {}",
        rows + (*columns).max(1) + lags
    )]
    TooShortForCorrelations {
        /// Samples after the first.
        parameters: usize,
        /// Rows of the Hankel matrices.
        rows: usize,
        /// Columns.
        columns: usize,
        /// The offset and twice the lag blocks.
        lags: usize,
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
    /// The shift of the observability matrix determines no state matrix.
    #[error("the {form} form determines no state matrix of order {order}; lower the order, or use the form hankel")]
    NoShift {
        /// The order asked for.
        order: usize,
        /// Name of the form.
        form: &'static str,
    },
    /// The realised matrices cannot be analysed.
    #[error(transparent)]
    System(#[from] LtiError),
}

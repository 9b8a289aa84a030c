//! What can be wrong with a system or a matrix.

/// Why a computation on a linear system has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LtiError {
    /// A matrix has the wrong shape.
    #[error("{what} is {rows} x {columns}, expected {expected}")]
    Shape {
        /// Which matrix.
        what: &'static str,
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
        /// The shape that fits.
        expected: String,
    },
    /// A matrix, polynomial or signal holds NaN or infinity.
    #[error("{what} holds a value that is not finite")]
    NotFinite {
        /// Which one.
        what: &'static str,
    },
    /// The sampling interval is zero, negative or not finite.
    #[error("sampling interval {0} s is not a positive number")]
    SampleTime(f64),
    /// The model is sampled and a continuous one is needed, or the other way round.
    #[error("the model is {found}, {needed} is needed")]
    TimeDomain {
        /// `discrete` or `continuous`.
        found: &'static str,
        /// What the computation works on.
        needed: &'static str,
    },
    /// The computation is for one input and one output.
    #[error("the model has {inputs} inputs and {outputs} outputs, one of each is needed")]
    NotSingle {
        /// Columns of `b`.
        inputs: usize,
        /// Rows of `c`.
        outputs: usize,
    },
    /// A real matrix logarithm does not exist.
    #[error("eigenvalue {re:.6e} lies on the closed negative real axis: there is no real logarithm")]
    NegativeRealEigenvalue {
        /// The eigenvalue.
        re: f64,
    },
    /// A sampled pole at zero.
    #[error("pole {re:.3e} of the sampled model is a delay: it has no continuous counterpart of any order")]
    Delay {
        /// The pole.
        re: f64,
    },
    /// An iteration did not settle.
    #[error("{what} did not converge in {iterations} iterations")]
    NotConverged {
        /// Which iteration.
        what: &'static str,
        /// Its limit.
        iterations: usize,
    },
    /// The result failed its own check.
    #[error("{what} is off by {relative_error:.1e} relative: the matrix is too ill-conditioned")]
    Inaccurate {
        /// Which result.
        what: &'static str,
        /// Relative residual of the check.
        relative_error: f64,
    },
    /// A polynomial without a non-zero coefficient, or without the degree needed.
    #[error("{what} has no non-zero leading coefficient")]
    NoLeadingCoefficient {
        /// Which polynomial.
        what: &'static str,
    },
    /// A proper transfer function has no more zeros than poles.
    #[error("numerator of degree {numerator} over denominator of degree {denominator} is not proper")]
    NotProper {
        /// Degree of the numerator.
        numerator: usize,
        /// Degree of the denominator.
        denominator: usize,
    },
    /// A matrix that must be inverted has no inverse.
    #[error("{what} is singular")]
    Singular {
        /// Which matrix.
        what: &'static str,
    },
}

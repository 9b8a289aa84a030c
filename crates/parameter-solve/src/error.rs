/// Why parameters cannot be solved for.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// A quantity of the test has no meaning.
    #[error("{name} is {value}, expected {expected}")]
    Value {
        /// What.
        name: &'static str,
        /// What it is.
        value: f64,
        /// What would do.
        expected: &'static str,
    },
    /// `t_c/t_m` is so small that the damping ratio has no meaning.
    #[error(
        "centroid time over time of dynamic crush is {ratio:.4}: its Kelvin damping ratio would be above 1e9, \
         that is no crash pulse"
    )]
    RatioTooSmall {
        /// `t_c/t_m`.
        ratio: f64,
    },
    /// The window holds too little.
    #[error("{samples} samples between {from_s} s and {to_s} s, a fit needs at least {needed}")]
    TooFewSamples {
        /// Samples found.
        samples: usize,
        /// Start of the window, s after time zero.
        from_s: f64,
        /// End of the window.
        to_s: f64,
        /// Smallest number that is fitted.
        needed: usize,
    },
    /// The window leaves the record.
    #[error(
        "the fit window {from_s} s to {to_s} s is not inside the displacement record, {first_s} s to {last_s} s after time zero"
    )]
    Window {
        /// Start asked for.
        from_s: f64,
        /// End asked for.
        to_s: f64,
        /// First sample at or after time zero.
        first_s: f64,
        /// Last sample.
        last_s: f64,
    },
    /// The model has no meaning.
    #[error(transparent)]
    Model(#[from] crumple_lumped::LumpedError),
    /// No start led to a finite error.
    #[error("none of {starts} starts of the fit led to a finite response")]
    NoFit {
        /// Starts tried.
        starts: usize,
    },
}

pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, SolveError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(SolveError::Value { name, value, expected: "a positive number" })
    }
}

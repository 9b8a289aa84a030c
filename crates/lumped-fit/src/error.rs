//! Why parameters cannot be solved for. Messages name the quantity, what it is, and what is expected.

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
    #[error("{samples} samples between {from_s:.6} s and {to_s:.6} s, a fit needs at least {needed}")]
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
        "the fit window {from_s:.6} s to {to_s:.6} s is not inside the displacement record, {first_s:.6} s to \
         {last_s:.6} s after time zero"
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
    /// Bounds or start of a free number of a chain.
    #[error("{name}: {problem}, expected positive numbers with lower below start below upper")]
    Bounds {
        /// The number.
        name: String,
        /// What is wrong.
        problem: String,
    },
    /// A chain to be fitted in which all is given.
    #[error("nothing of the chain is free, expected at least one mass, spring or damper that is")]
    NothingFree,
    /// A mass that is the rest, of nothing.
    #[error("a mass of the chain is the rest of the total, and the total mass is not known")]
    RestWithoutTotal,
    /// Two of them.
    #[error("two masses of the chain are the rest of the total, expected one at most")]
    TwoRests,
    /// The masses given leave nothing.
    #[error(
        "the masses given for the chain are {given_kg} kg of a total of {total_kg} kg: they leave nothing for the rest"
    )]
    NothingLeft {
        /// Total.
        total_kg: f64,
        /// Sum of those given.
        given_kg: f64,
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

/// The value, if it is positive and finite. Errors: else, with `name`, which carries the unit.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, SolveError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(SolveError::Value { name, value, expected: "a positive number" })
    }
}

//! What a sum of exponentials is fitted with.

use crumple_estimation::minimise::Stop;
use crumple_lti::Complex;

/// Settings of [`exponential_sum`](crate::exponential_sum()).
#[derive(Debug, Clone, PartialEq)]
pub struct ExponentialOptions {
    /// Number of terms; a damped wave counts as two.
    pub terms: usize,
    /// Whether every exponent is real.
    pub real: bool,
    /// Value and derivatives at the first sample that the sum must have, from the value on: for a crash from contact
    /// `[0, v0]`, for a compartment behind a crushing front `[0, v0, 0]`. At most as many as terms.
    pub start: Vec<f64>,
    /// Whether terms must not grow.
    pub stable: bool,
    /// Random starting points beside that of the matrix pencil.
    pub random_starts: usize,
    /// Exponents to start from, 1/s; where there are any, nothing else is tried but the random ones.
    pub given: Vec<Vec<Complex>>,
    /// When to stop.
    pub stop: Stop,
}

impl ExponentialOptions {
    /// Of so many terms: real or complex, not growing, free at the start, 20 random starts.
    pub fn new(terms: usize) -> Self {
        Self {
            terms,
            real: false,
            start: Vec::new(),
            stable: true,
            random_starts: 20,
            given: Vec::new(),
            stop: Stop::default(),
        }
    }
}

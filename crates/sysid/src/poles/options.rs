//! What a transfer function is fitted with.

use crumple_numerics::estimation::minimise::Stop;
use crumple_numerics::lti::Complex;

use crate::Hold;
use crate::poles::starts::Start;

/// What is assumed of the system's motion before the record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InitialConditions {
    /// At rest.
    Zero,
    /// Any free motion, estimated with the model. With more outputs than inputs, where each has a motion of its own
    /// instead of one of the model's states: only if the BIC (effective samples) says so.
    Estimate,
    /// Estimated if that lowers the loss by more than an F-test at 5 % allows for chance.
    Auto,
}

/// Settings of [`transfer_function_fit`](crate::transfer_function_fit()).
///
/// Number of unknowns of one input and one output: `poles`, `zeros + 1`, and `poles` more for an estimated initial
/// motion.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunctionOptions {
    /// Number of poles.
    pub poles: usize,
    /// Number of zeros, at most that of the poles.
    pub zeros: usize,
    /// Input between samples.
    pub hold: Hold,
    /// Samples by which the input acts late.
    pub delay: usize,
    /// Motion before the record.
    pub initial: InitialConditions,
    /// Whether poles are kept from growing.
    pub stable: bool,
    /// Ways to starting points.
    pub starts: Vec<Start>,
    /// Number of random ones among them.
    pub random_starts: usize,
    /// Poles to start from as well, 1/s.
    pub given: Vec<Vec<Complex>>,
    /// When to stop.
    pub stop: Stop,
}

impl TransferFunctionOptions {
    /// Of so many poles and zeros: first-order hold, initial conditions estimated, every start, growth allowed.
    pub fn new(poles: usize, zeros: usize) -> Self {
        Self {
            poles,
            zeros,
            hold: Hold::First,
            delay: 0,
            initial: InitialConditions::Estimate,
            stable: false,
            starts: vec![Start::Svf, Start::Iv, Start::N4sid, Start::Arx, Start::Integrators, Start::Random],
            random_starts: 24,
            given: Vec::new(),
            stop: Stop::default(),
        }
    }
}

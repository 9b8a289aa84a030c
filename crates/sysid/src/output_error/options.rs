//! What an output-error model is fitted with.

use crumple_numerics::estimation::minimise::Stop;

use crate::InitialConditions;

/// Settings of [`output_error`](crate::output_error()).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputErrorOptions {
    /// Number of poles.
    pub order: usize,
    /// Whether outputs may follow an input within the same sample.
    pub direct: bool,
    /// Samples by which every input acts late.
    pub delay: usize,
    /// Motion before the record.
    pub initial: InitialConditions,
    /// Whether poles are kept from growing.
    pub stable: bool,
    /// Random starting points in addition to those from ARX and subspace models.
    pub random_starts: usize,
    /// When to stop.
    pub stop: Stop,
}

impl OutputErrorOptions {
    /// Of an order, with a direct term, without delay, motion estimated, stable, 8 random starts.
    pub fn new(order: usize) -> Self {
        Self {
            order,
            direct: true,
            delay: 0,
            initial: InitialConditions::Estimate,
            stable: true,
            random_starts: 8,
            stop: Stop::default(),
        }
    }
}

//! What an output-error model is fitted with.

use crumple_numerics::estimation::minimise::Stop;

/// Settings of [`output_error`](crate::output_error()).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputErrorOptions {
    /// Number of poles.
    pub order: usize,
    /// Whether outputs may follow an input within the same sample.
    pub direct: bool,
    /// Samples by which every input acts late.
    pub delay: usize,
    /// Whether the record starts from rest; else it starts in a motion of its own, which is fitted.
    pub from_rest: bool,
    /// Random starting points in addition to those from ARX and subspace models.
    pub random_starts: usize,
    /// When to stop.
    pub stop: Stop,
}

impl OutputErrorOptions {
    /// Of an order, with a direct term, without delay, in motion, 8 random starts.
    pub fn new(order: usize) -> Self {
        Self { order, direct: true, delay: 0, from_rest: false, random_starts: 8, stop: Stop::default() }
    }
}

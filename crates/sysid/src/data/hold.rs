//! What an input does between its samples.

/// What the input does between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// It keeps the value of the last sample.
    Zero,
    /// It goes straight to the next sample: right for sampled accelerations, error O(dt²).
    First,
}

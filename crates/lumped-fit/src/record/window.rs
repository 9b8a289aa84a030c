//! Samples of a record with their instants, for searches that need no more of it.
//!
//! Samples are picked, never interpolated: the response of a model is exact at any spacing, so leaving samples out
//! costs no accuracy of the comparison, only some of the averaging of noise.

/// Fewest samples of a record or wave that are compared.
pub(crate) const FEWEST: usize = 12;

/// Evenly spaced samples of a window of a record: every `stride`-th one, none interpolated.
///
/// Picking loses nothing here, since the model's response is exact at any spacing; it only leaves out samples.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Window {
    /// Time of the first sample after time zero, s.
    pub first_s: f64,
    /// Their spacing, s.
    pub dt_s: f64,
    /// The samples.
    pub samples: Vec<f64>,
}

impl Window {
    /// Time of the last sample, s after time zero.
    pub fn last_s(&self) -> f64 {
        self.first_s + self.dt_s * (self.samples.len() - 1) as f64
    }
}

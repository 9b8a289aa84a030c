//! A channel that was filtered, as the later steps of the stage change it.

use crumple_signal::{Coefficients, Filtered, QuantityKind};

/// What was done to a channel after filtering.
#[derive(Default)]
pub struct Extra {
    pub resampled_to_hz: Option<f64>,
    /// The filter at the rate that is kept, and the samples it mirrors at each end there; `None`: all samples are kept.
    pub as_kept: Option<(Coefficients, usize)>,
}

/// A channel on its way out.
pub struct FilteredChannel {
    pub id: String,
    pub quantity: QuantityKind,
    pub filtered: Filtered,
    pub extra: Extra,
}

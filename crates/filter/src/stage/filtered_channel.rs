//! A channel that was filtered, as the later steps of the stage change it.

use crumple_filter::{Coefficients, Filtered};
use crumple_signal::QuantityKind;

/// What was done to a channel after filtering.
#[derive(Default)]
pub struct Extra {
    pub shift_s: Option<f64>,
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
    /// Here for the criteria of an occupant, not to be held against the vehicle.
    pub for_criteria: bool,
}

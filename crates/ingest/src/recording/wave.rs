//! A channel with data, as it is written.

use crumple_signal::{QuantityKind, Sampled};

use crate::recording::quality::Quality;

/// A channel's samples and what was measured on them.
#[derive(Debug, Clone)]
pub struct Wave {
    /// Id of the channel.
    pub id: String,
    /// What is measured.
    pub quantity: QuantityKind,
    /// Samples in SI, t = 0 at first contact.
    pub samples: Sampled,
    /// State as read.
    pub quality: Quality,
}

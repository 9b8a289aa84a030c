//! What is known of a crash test beside its samples.

use crate::{Channel, QuantityKind};

/// What stands in place of a barrier where the vehicle met another one.
pub const ANOTHER_VEHICLE: &str = "another vehicle";

/// Where a record came from.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Source {
    /// The file format as recognised, e.g. `csv`, `nhtsa-ev5`.
    pub format: String,
    /// The file's name without its folder.
    pub name: String,
    /// Digest of the content, `blake3:<hex>`.
    pub digest: String,
}

/// A crash test: title, vehicle, masses and speeds where known, and its channels.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TestDescription {
    /// Title as the source gives it, else the file's stem.
    pub title: String,
    /// Vehicle, in words.
    pub vehicle: Option<String>,
    /// Test mass, kg.
    pub mass_kg: Option<f64>,
    /// Speed just before contact, m/s, positive.
    pub impact_speed_m_per_s: Option<f64>,
    /// Barrier, in words.
    pub barrier: Option<String>,
    /// Where the record came from.
    pub source: Source,
    /// Every channel the source lists.
    pub channels: Vec<Channel>,
    /// Id of the channel taken as the crash pulse.
    pub pulse: Option<String>,
    /// Remarks of the reader of the file.
    pub notes: Vec<String>,
    /// What says that t = 0 is first contact, in words: the format, or the person who stated it; `None`: nothing.
    pub time_zero: Option<String>,
    /// Whether its reader asked for an exchange of unit, speed, time or sign that makes pulse and impact speed fit.
    pub exchange_asked: bool,
}

/// Why no channel can be taken as the pulse.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PulseError {
    /// The named channel is not in the test.
    #[error("the test names {0:?} as its pulse, but has no such channel")]
    Unknown(String),
    /// There is no acceleration.
    #[error("the test has no acceleration channel with data")]
    None,
    /// There are several, and the test does not say which.
    #[error("the test has {0} acceleration channels and does not say which is the pulse")]
    Several(usize),
}

impl TestDescription {
    /// The channel with this id.
    pub fn channel(&self, id: &str) -> Option<&Channel> {
        self.channels.iter().find(|c| c.id == id)
    }

    /// The channel taken as the crash pulse: the one the record names, else its only acceleration channel with data.
    pub fn pulse_channel(&self) -> Result<&Channel, PulseError> {
        if let Some(id) = &self.pulse {
            return self.channel(id).ok_or_else(|| PulseError::Unknown(id.clone()));
        }
        let mut candidates =
            self.channels.iter().filter(|c| c.quantity == QuantityKind::Acceleration && c.status.has_data());
        match (candidates.next(), candidates.count()) {
            (None, _) => Err(PulseError::None),
            (Some(only), 0) => Ok(only),
            (Some(_), more) => Err(PulseError::Several(more + 1)),
        }
    }
}

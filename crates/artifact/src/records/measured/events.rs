//! Record: the events of a crash on one channel.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Interval of an event, from the stated uncertainty of the measurement.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EventIntervalV1 {
    /// Field of [`EventsV1`] it belongs to, e.g. `dynamic_crush_m`.
    pub name: String,
    /// Lower end, unit of the field.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// How it was found, e.g. `5-95 % of 400 replicates`.
    pub interval_by: String,
}

/// Why an event has no interval.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MissingIntervalV1 {
    /// Field of [`EventsV1`], e.g. `dynamic_crush_m`.
    pub name: String,
    /// The reason in words.
    pub reason: String,
}

/// The events of a crash on one channel; times count from time zero. Topic `/events`.
///
/// `null` means that the record does not show the event; a note says why.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EventsV1 {
    /// Channel the events were read from.
    pub channel: String,
    /// Time zero on the record's own time axis, s.
    pub time_zero_s: f64,
    /// How time zero was found: `file`, `flag`, ...
    pub time_zero_rule: String,
    /// Dynamic crush C: displacement at the first zero of velocity, m.
    pub dynamic_crush_m: Option<f64>,
    /// Time of dynamic crush t_m, s.
    pub time_of_dynamic_crush_s: Option<f64>,
    /// Centroid time t_c of the loading pulse, s.
    pub centroid_time_s: Option<f64>,
    /// Lowest velocity after t_m, m/s, negative when the vehicle rebounds.
    pub rebound_velocity_m_per_s: Option<f64>,
    /// Coefficient of restitution e = -rebound velocity / impact speed.
    pub coefficient_of_restitution: Option<f64>,
    /// Whether the record ends during the rebound: its lowest velocity is the last sample, so that restitution and
    /// delta-v are lower bounds.
    #[serde(default)]
    pub still_separating: bool,
    /// Change of velocity, impact speed minus rebound velocity, m/s; of a velocity that never reaches zero impact speed
    /// minus the lowest velocity up to `end_of_event_s`.
    pub delta_v_m_per_s: Option<f64>,
    /// Time of the rebound velocity, s.
    pub time_of_rebound_s: Option<f64>,
    /// Impact speed the integration started from, m/s.
    pub impact_speed_m_per_s: Option<f64>,
    /// Integration rule: `trapezoid` or `forward-euler`.
    pub rule: Option<String>,
    /// Where the integration started: `time-zero` or `record-start`.
    pub start: Option<String>,
    /// Intervals of the events, where the uncertainty of the measurement was stated.
    #[serde(default)]
    pub intervals: Vec<EventIntervalV1>,
    /// Time of the lowest velocity of an event whose velocity never reaches zero, s; elsewhere it is
    /// `time_of_rebound_s`.
    #[serde(default)]
    pub time_of_delta_v_s: Option<f64>,
    /// End of an event whose velocity never reaches zero, s; `null` where it does, or where nothing happens.
    #[serde(default)]
    pub end_of_event_s: Option<f64>,
    /// What ends it: `20 ms with no more than 0.8 km/h (49 CFR 563)` or `end of the record`.
    #[serde(default)]
    pub end_of_event_rule: Option<String>,
    /// Events that have no interval although the uncertainty of the measurement was stated, and why.
    #[serde(default)]
    pub without_interval: Vec<MissingIntervalV1>,
}

impl EventsV1 {
    /// End of the contact with the barrier, s after time zero: the lowest velocity, where the vehicle separates, else
    /// the end of a record that ends at `record_end_s` on its own axis.
    pub fn end_of_contact_s(&self, record_end_s: f64) -> f64 {
        let end_s = record_end_s - self.time_zero_s;
        self.time_of_rebound_s.or(self.time_of_delta_v_s).map_or(end_s, |t| t.min(end_s))
    }
}

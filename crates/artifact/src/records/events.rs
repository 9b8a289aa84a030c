use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The events of a crash on one channel; times count from time zero. Topic `/events`.
///
/// `null` means that the record does not show the event; a note says why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
    /// Change of velocity, impact speed minus rebound velocity, m/s.
    pub delta_v_m_per_s: Option<f64>,
    /// Time of the rebound velocity, s.
    pub time_of_rebound_s: Option<f64>,
    /// Impact speed the integration started from, m/s.
    pub impact_speed_m_per_s: Option<f64>,
    /// Integration rule: `trapezoid` or `forward-euler`.
    pub rule: Option<String>,
    /// Where the integration started: `time-zero` or `record-start`.
    pub start: Option<String>,
}

//! Record: what ingest measured on a channel.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What ingest measured on a channel before any processing. Topic `/quality/<channel id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct QualityV1 {
    /// Mean before the event, SI unit of the channel; `null` without enough pre-event data.
    pub zero_level: Option<f64>,
    /// Standard deviation before the event.
    pub noise_floor: Option<f64>,
    /// Pre-event window: start, s.
    pub pre_event_from_s: Option<f64>,
    /// Pre-event window: end, s.
    pub pre_event_to_s: Option<f64>,
    /// Sampling rate, Hz.
    pub sample_rate_hz: f64,
    /// Largest deviation of a time stamp from the uniform grid, in sampling intervals.
    pub time_jitter: f64,
    /// Smallest sample.
    pub minimum: f64,
    /// Largest sample.
    pub maximum: f64,
    /// Longest run of equal samples at an extreme (3 or more: clipped).
    pub clipped_run: u64,
    /// Longest run of equal samples while the signal is active after time zero (5 or more over 0.5 ms: a dropout,
    /// perhaps).
    #[serde(default)]
    pub constant_run: Option<u64>,
    /// Start of that run, s.
    #[serde(default)]
    pub constant_run_from_s: Option<f64>,
    /// Mean over the last 20 ms, zero level removed, SI unit of the channel.
    #[serde(default)]
    pub end_level: Option<f64>,
    /// Level at rest of an acceleration in free fall before the event, 1 g off `zero_level`, m/s²; `null`: no free fall
    /// shows.
    #[serde(default)]
    pub rest_level: Option<f64>,
}

impl QualityV1 {
    /// Equal samples in a row at an extreme from which on a channel may be clipped.
    pub const CLIPPED_RUN: u64 = 3;

    /// Whether the channel may be clipped.
    pub fn may_be_clipped(&self) -> bool {
        self.clipped_run >= Self::CLIPPED_RUN
    }
}

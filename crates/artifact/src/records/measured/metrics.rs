//! Record: crash metrics.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Crash metrics. Topic `/metrics`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MetricsV2 {
    /// The metrics, in the order of channels.
    pub metrics: Vec<MetricV1>,
}

/// Crash metrics as they were written before: a JSON array.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct MetricsV1(pub Vec<MetricV1>);

impl From<MetricsV1> for MetricsV2 {
    fn from(earlier: MetricsV1) -> Self {
        Self { metrics: earlier.0 }
    }
}

/// One number about a channel.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MetricV1 {
    /// Name, e.g. `peak_acceleration`.
    pub name: String,
    /// Value; `null` where the record does not show it.
    pub value: Option<f64>,
    /// SI unit.
    pub unit: String,
    /// Channel it was computed from.
    pub channel: String,
    /// Definition, or the reason for a missing value.
    pub definition: String,
    /// Key of the definition in the catalogue of `docs/metrics.md`, e.g. `olc-tb027`.
    pub definition_id: Option<String>,
    /// Start of the part of the record the value belongs to, s from time zero; `null` where it belongs to none.
    pub from_s: Option<f64>,
    /// Its end, s from time zero; the start again for a moment.
    pub to_s: Option<f64>,
    /// Lower end of the interval of the value, from stated or measured uncertainty.
    pub low: Option<f64>,
    /// Its upper end.
    pub high: Option<f64>,
    /// How the interval was found, e.g. `5-95 % of 400 replicates` or `range over 4 channels`; without one why there is
    /// none, where one was to be expected.
    pub interval_by: Option<String>,
}

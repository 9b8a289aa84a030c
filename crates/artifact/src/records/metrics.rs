use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Crash metrics. Topic `/metrics`; the record is a JSON array.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct MetricsV1(pub Vec<MetricV1>);

/// One number about a channel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
}

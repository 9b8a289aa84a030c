use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a channel was filtered. Topic `/filter/<channel id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ChannelFilterV1 {
    /// Channel frequency class applied; `null`: passed through.
    pub cfc: Option<u16>,
    /// `iso6487`, `sae_reflect`, `sae_zero_state` or `none`.
    pub mode: String,
    /// Ratio of the design frequency to the class, e.g. 2.0775.
    pub frequency_factor: Option<f64>,
    /// Samples added at each end before filtering.
    pub samples_added: u64,
    /// Coefficients a0, a1, a2, b1, b2 of `y[i] = a0 x[i] + a1 x[i-1] + a2 x[i-2] + b1 y[i-1] + b2 y[i-2]`.
    pub coefficients: Vec<f64>,
    /// Gain of both passes at the class frequency, dB.
    pub gain_at_class_db: Option<f64>,
    /// Zero level subtracted before filtering, SI unit of the channel.
    pub zero_level_removed: f64,
    /// What a reader should know.
    pub notes: Vec<String>,
}

//! Record: how a channel was filtered.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a channel was filtered. Topic `/filter/<channel id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ChannelFilterV1 {
    /// Channel frequency class applied; `null`: passed through.
    pub cfc: Option<u16>,
    /// `iso6487`, `sae_reflect`, `sae_zero_state`, `butterworth-low`, `butterworth-high`, `butterworth-band`,
    /// `moving-average` or `none`.
    pub mode: String,
    /// Ratio of the design frequency to the class, e.g. 2.0775.
    pub frequency_factor: Option<f64>,
    /// Samples added at each end before filtering.
    pub samples_added: u64,
    /// Coefficients a0, a1, a2, b1, b2 of `y[i] = a0 x[i] + a1 x[i-1] + a2 x[i-2] + b1 y[i-1] + b2 y[i-2]`; five for
    /// each section of a Butterworth filter, sections in the order they are run.
    pub coefficients: Vec<f64>,
    /// Gain of both passes at the class frequency, dB.
    pub gain_at_class_db: Option<f64>,
    /// Zero level subtracted before filtering, SI unit of the channel.
    pub zero_level_removed: f64,
    /// What a reader should know.
    pub notes: Vec<String>,
    /// Response of the filter that was run beside the limits of its class; empty without a class.
    #[serde(default)]
    pub corridor: Vec<CorridorPointV1>,
    /// Whether the response keeps all limits of the class; `null` without a class.
    pub corridor_ok: Option<bool>,
    /// Cut-off frequencies of a Butterworth filter, Hz: one, or two for a band.
    #[serde(default)]
    pub cutoff_hz: Vec<f64>,
    /// `zero` (forward and backward, no phase) or `causal`; `null`: nothing was filtered.
    pub phase: Option<String>,
    /// Width of a moving average, s.
    pub width_s: Option<f64>,
    /// Sampling rate the channel was brought to after filtering, Hz; `null`: its own.
    pub resampled_to_hz: Option<f64>,
    /// Shift of the time axis that aligns the channel with another, s; negative: the channel was late.
    pub shift_s: Option<f64>,
}

/// The gain of a filter at one frequency, and what its class allows there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CorridorPointV1 {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Gain of the filter as run, dB.
    pub gain_db: f64,
    /// Upper limit, dB.
    pub upper_db: f64,
    /// Lower limit, dB; `null`: none.
    pub lower_db: Option<f64>,
}

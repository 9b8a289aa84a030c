//! Record: responses of an identified model.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Responses of an identified model, ready to be drawn. Topic `/response/<id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ResponseV1 {
    /// What drives the model, in words.
    pub input: String,
    /// What it answers with, in words.
    pub output: String,
    /// Which model's frequency response this is: `continuous`, or `discrete` where there is no continuous one.
    pub model: String,
    /// Frequencies, Hz, rising: evenly spaced in the logarithm, with more of them at resonances.
    pub frequency_hz: Vec<f64>,
    /// Modulus of the frequency response, SI units.
    pub magnitude: Vec<f64>,
    /// Phase, unwrapped, rad.
    pub phase_rad: Vec<f64>,
    /// Where the band comes from, e.g. `covariance, 5 to 95 %`; `null` without a band.
    pub band: Option<String>,
    /// Lower edge of the band of the modulus; `null` where it is not determined. Empty without a band.
    pub magnitude_lower: Vec<Option<f64>>,
    /// Upper edge.
    pub magnitude_upper: Vec<Option<f64>>,
    /// Lower edge of the band of the phase, rad.
    pub phase_lower_rad: Vec<Option<f64>>,
    /// Upper edge, rad.
    pub phase_upper_rad: Vec<Option<f64>>,
    /// What the impulse response answers to: `unit impulse` of a continuous model, `unit sample` of a sampled one.
    pub impulse_of: String,
    /// Times of both responses, s.
    pub time_s: Vec<f64>,
    /// Response to the impulse, from rest.
    pub impulse: Vec<f64>,
    /// Response to a unit step, from rest.
    pub step: Vec<f64>,
    /// Real parts of the zeros of the continuous model, 1/s; empty where there is none.
    pub zeros_re_per_s: Vec<f64>,
    /// Their imaginary parts, rad/s.
    pub zeros_im_rad_per_s: Vec<f64>,
}

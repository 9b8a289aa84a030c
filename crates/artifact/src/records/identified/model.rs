//! Records: identified models (state space, transfer function, exponential sum) and their modes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A linear state-space model. Topic `/model/<id>`. Matrices are lists of rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StateSpaceV1 {
    /// State matrix, n x n.
    pub a: Vec<Vec<f64>>,
    /// Input matrix, n x inputs.
    pub b: Vec<Vec<f64>>,
    /// Output matrix, outputs x n.
    pub c: Vec<Vec<f64>>,
    /// Direct term, outputs x inputs.
    pub d: Vec<Vec<f64>>,
    /// Sample time, s; 0 for a continuous model.
    pub sample_time_s: f64,
    /// What drives the model, in words.
    pub input: String,
    /// What it answers with, in words.
    pub output: String,
    /// Time by which the input acts late, s, beyond what the matrices hold: the response is that of the model, moved to
    /// later times by it. `null`: no delay.
    pub delay_s: Option<f64>,
}

/// A continuous transfer function. Topic `/model/<id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TransferFunctionV1 {
    /// Numerator coefficients, highest power of s first.
    pub numerator: Vec<f64>,
    /// Denominator coefficients, highest power first, the first is 1.
    pub denominator: Vec<f64>,
    /// What drives the model, in words.
    pub input: String,
    /// What it answers with, in words.
    pub output: String,
    /// Time by which the input acts late, s, beyond what the coefficients hold: the response is that of the model,
    /// moved to later times by it. `null`: no delay.
    pub delay_s: Option<f64>,
}

/// A sum of complex exponentials. Topic `/model/<id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExponentialSumV1 {
    /// Terms; a real signal has them real or in conjugate pairs.
    pub terms: Vec<ExponentialTermV1>,
    /// What the sum describes, in words.
    pub output: String,
}

/// `(re_amplitude + i im_amplitude) exp((re_per_s + i im_rad_per_s) t)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExponentialTermV1 {
    /// Real part of the amplitude.
    pub re_amplitude: f64,
    /// Imaginary part of the amplitude.
    pub im_amplitude: f64,
    /// Real part of the exponent, 1/s.
    pub re_per_s: f64,
    /// Imaginary part of the exponent, rad/s.
    pub im_rad_per_s: f64,
}

/// Modes of a model. Topic `/modes/<id>`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModesV2 {
    /// One entry a pole that is a mode.
    pub modes: Vec<ModeV1>,
    /// The poles of the model that are no modes.
    #[serde(default)]
    pub other_poles: Vec<OtherPoleV1>,
}

/// A pole that is no mode of the record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OtherPoleV1 {
    /// Real part, continuous time, 1/s.
    pub re_per_s: f64,
    /// Imaginary part, rad/s.
    pub im_rad_per_s: f64,
    /// The discrete pole, real part.
    pub discrete_re: Option<f64>,
    /// The discrete pole, imaginary part.
    pub discrete_im: Option<f64>,
    /// Why it is none.
    pub kind: OtherPoleKindV1,
}

/// Why a pole is no mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OtherPoleKindV1 {
    /// At or near zero: the model integrates.
    Integrator,
    /// At or beyond the Nyquist frequency of the record.
    BeyondNyquist,
}

/// Modes of a model as they were written before: a JSON array.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct ModesV1(pub Vec<ModeV1>);

impl From<ModesV1> for ModesV2 {
    fn from(earlier: ModesV1) -> Self {
        Self { modes: earlier.0, other_poles: Vec::new() }
    }
}

/// One mode of a model, continuous time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModeV1 {
    /// Real part of the pole, 1/s.
    pub re_per_s: f64,
    /// Imaginary part, rad/s.
    pub im_rad_per_s: f64,
    /// Natural frequency, modulus of the pole, rad/s.
    pub natural_frequency_rad_per_s: f64,
    /// Damping ratio, -re/modulus; `null` for a pole at zero.
    pub damping_ratio: Option<f64>,
    /// Modal amplitude coherence, 0 to 1, where the method gives one.
    pub modal_amplitude_coherence: Option<f64>,
    /// Mode singular value, relative to the largest, where the method gives one.
    pub mode_singular_value: Option<f64>,
    /// The discrete pole, real part.
    pub discrete_re: Option<f64>,
    /// The discrete pole, imaginary part.
    pub discrete_im: Option<f64>,
}

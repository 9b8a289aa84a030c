//! Records of identify: models, modes, how they were chosen and what supports them.

use serde::{Deserialize, Serialize};

use crate::records::RemarkV1;

// Record: validation of an identified model.

/// Validation of an identified model beyond its fit. Topic `/evidence/<id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct EvidenceV1 {
    /// Channel that drives the model; `null` for a free motion.
    pub input: Option<String>,
    /// Channel it answers with.
    pub output: String,
    /// Input between samples: `first-order` or `zero-order` hold; `null` without an input.
    pub hold: Option<String>,
    /// Initial conditions: `estimated`, `zero`, or `held: ` and what is held with its values.
    pub initial_conditions: String,
    /// Kind of the start that led to the model.
    pub start: Option<String>,
    /// Why the iteration stopped, e.g. `gradient-converged`; `null` for a direct method.
    pub stop_reason: Option<String>,
    /// Iterations of the best start.
    pub iterations: Option<u32>,
    /// Evaluations of all starts.
    pub evaluations: Option<u64>,
    /// Mean square error of every refined start, best first, square of the output's unit.
    pub losses: Vec<f64>,
    /// Mean square error of the simulated output, square of its unit.
    pub loss: Option<f64>,
    /// Fit of the one-step prediction, where the method has one; it says little about a simulation.
    pub prediction_fit_percent: Option<f64>,
    /// Number of estimated parameters.
    pub parameters: u64,
    /// Number of independent samples that the correlated residuals are worth.
    pub effective_samples: Option<f64>,
    /// Akaike's criterion for short records, with the effective number of samples.
    pub aicc: Option<f64>,
    /// Schwarz's criterion, likewise.
    pub bic: Option<f64>,
    /// Akaike's final prediction error, likewise, square of the output's unit.
    pub final_prediction_error: Option<f64>,
    /// Autocorrelation of the simulation errors at lag one.
    pub residual_lag_one: Option<f64>,
    /// Box-Pierce statistic over 20 lags: of the one-step prediction errors where the method has a predictor, else of
    /// the simulation errors; the notes of `/identification/<id>` say which.
    pub whiteness: Option<f64>,
    /// Its 95 % point.
    pub whiteness_limit: Option<f64>,
    /// Largest correlation of the same errors with the input, in units of its 95 % limit.
    pub input_correlation: Option<f64>,
    /// Condition number of the column-scaled sensitivities; above 1e8 single parameters mean little.
    pub condition: Option<f64>,
    /// Standard deviations of the numerator's coefficients, highest power first.
    pub numerator_deviations: Vec<f64>,
    /// Standard deviations of the denominator's coefficients after the leading 1.
    pub denominator_deviations: Vec<f64>,
    /// Standard deviations of the natural frequencies of the modes, rad/s, in their order.
    pub frequency_deviations: Vec<Option<f64>>,
    /// Standard deviations of the damping ratios of the modes.
    pub damping_deviations: Vec<Option<f64>>,
    /// Real parts of the zeros, 1/s.
    pub zeros_re_per_s: Vec<f64>,
    /// Their imaginary parts, rad/s.
    pub zeros_im_rad_per_s: Vec<f64>,
    /// Bounds of the errors of the singular values in `/identification/<id>`, one each.
    pub singular_value_errors: Vec<f64>,
    /// Standard deviations of the real parts of the zeros, 1/s; `null` where not determined. Empty without them.
    pub zero_re_deviations: Vec<Option<f64>>,
    /// The same of their imaginary parts, rad/s.
    pub zero_im_deviations: Vec<Option<f64>>,
    /// Replicates of the bootstrap that led to a model; `null` without a bootstrap.
    pub bootstrap_replicates: Option<u32>,
    /// Replicates that did not.
    pub bootstrap_failed: Option<u32>,
    /// How their noise was drawn, in words.
    pub bootstrap_noise: Option<String>,
    /// Spread over the replicates of the natural frequency of every mode, rad/s, in their order.
    pub frequency_spreads: Vec<Option<SpreadV1>>,
    /// The same of the damping ratio.
    pub damping_spreads: Vec<Option<SpreadV1>>,
    /// The same of the real part of every zero, 1/s.
    pub zero_re_spreads: Vec<Option<SpreadV1>>,
    /// The same of its imaginary part, rad/s.
    pub zero_im_spreads: Vec<Option<SpreadV1>>,
    /// Fit of the samples kept for validation, which the model has not seen, percent.
    pub validation_fit_percent: Option<f64>,
    /// First of these samples, s on the record's time axis.
    pub validation_from_s: Option<f64>,
    /// The paper whose procedure this is, as printed: `era`, `curve-fit` or `tfest`.
    pub paper: Option<String>,
    /// Fit of the samples kept for validation with the initial state fitted on them, percent; `validation_fit_percent`
    /// runs on with the state that the model has at the end of the samples it was identified from.
    pub validation_restarted_fit_percent: Option<f64>,
    /// Akaike's criterion, with the effective number of samples.
    pub aic: Option<f64>,
    /// Minimum description length, likewise, square of the output's unit.
    pub minimum_description_length: Option<f64>,
    /// Variance of the output that the simulation accounts for, percent.
    pub vaf_percent: Option<f64>,
    /// Why there are no standard deviations of frequencies and damping ratios; `null` where there are.
    pub no_deviations: Option<String>,
    /// Names of numbers of the model whose correlations are known, e.g. `re_per_s_1`.
    pub parameter_names: Vec<String>,
    /// Their values.
    pub parameter_values: Vec<f64>,
    /// Their standard deviations, from the linearised fit, inflated for correlated residuals.
    pub parameter_deviations: Vec<f64>,
    /// Their correlations, row after row.
    pub parameter_correlations: Vec<Vec<f64>>,
    /// Covariance of the denominator's coefficients after the leading 1, rows in their order. Empty where it is not
    /// known.
    pub denominator_covariance: Vec<Vec<f64>>,
    /// Whether the model holds on the samples kept for validation, with its state fitted to them where the method gives
    /// that, else run on: a fit of at least 0, and at most 30 points below that of the samples of this output that it
    /// was identified from. `null`: it has seen all.
    #[serde(default)]
    pub holds_on_unseen: Option<bool>,
    /// Box-Pierce statistic over 20 lags of the errors of the simulation, whatever `whiteness` is of; above
    /// `whiteness_limit` they are correlated, and deviations that take them for white are too small.
    pub simulation_whiteness: Option<f64>,
    /// The noise of this output as the one-step prediction shows it; intervals are drawn from it. `null`: not looked
    /// at, or no model of it.
    pub noise: Option<NoiseV1>,
    /// Why no mode has an interval, although a bootstrap was asked for.
    pub no_interval: Option<NoIntervalV1>,
    /// Why a mode has none while others do, in the order of the modes; empty without a bootstrap.
    #[serde(default)]
    pub no_spreads: Vec<Option<NoSpreadV1>>,
}

/// The noise of an output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct NoiseV1 {
    /// Model of it with the smaller BIC of the one-step prediction.
    pub model: NoiseModelV1,
    /// Order of the autoregression of the simulation's errors; 0 of white ones and of `arx`.
    pub ar_order: u32,
    /// Ljung-Box statistic over 25 lags of the one-step prediction errors of that model.
    pub ljung_box: f64,
    /// Its 95 % point; more than twice as much is not white.
    pub white_limit: f64,
    /// Whether the errors are white: intervals are drawn from no others.
    pub is_white: bool,
}

/// What makes the noise of an output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum NoiseModelV1 {
    /// It is added to the output: white, or an autoregression of its own.
    OutputError,
    /// It goes through the poles of the system itself.
    Arx,
}

/// Why no mode has an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum NoIntervalV1 {
    /// Neither noise model leaves white errors: what was drawn from one would be too narrow.
    NotWhite,
    /// No noise model of this order was found.
    NoNoiseModel,
    /// Fewer than half of the replicates led to a model.
    FewReplicates,
}

/// Why one mode has no interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum NoSpreadV1 {
    /// Most replicates do not find it again.
    NotFoundAgain,
    /// Its frequency varies by more than 20 %.
    NotDetermined,
    /// The record is shorter than two of its time constants, and of a free motion than half of its period too.
    ShortRecord,
}

/// Spread of a number over the replicates of a bootstrap, and its interval about the estimate:
/// `estimate -+ 1.645 sqrt(deviation² + bias²)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct SpreadV1 {
    /// Standard deviation.
    pub deviation: f64,
    /// Lower end of the nominal 90 % interval.
    pub lower: f64,
    /// Its upper end.
    pub upper: f64,
    /// Mean over the replicates less the number of the model that they were drawn from; `null` in earlier artifacts,
    /// whose ends are percentiles.
    pub bias: Option<f64>,
}

// Record: how a model was identified and how well it fits.

/// How a model was identified and how well it fits. Topic `/identification/<id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct IdentificationV1 {
    /// Method, e.g. `era`.
    pub method: String,
    /// Model order (number of states).
    pub order: u32,
    /// Channel the model was identified from; several outputs separated by ", ".
    pub channel: String,
    /// What the samples were taken for: `impulse-response`, `free-decay`, `input-output` or `ambient`.
    pub treated_as: String,
    /// Window on the record's time axis: first sample, s.
    pub from_s: f64,
    /// Window: last sample, s.
    pub to_s: f64,
    /// Number of samples used.
    pub samples: u64,
    /// Rows of the Hankel matrix, where the method has one.
    pub hankel_rows: Option<u32>,
    /// Columns of the Hankel matrix, where the method has one.
    pub hankel_columns: Option<u32>,
    /// Singular values of the Hankel matrix, largest first, as far as they converged.
    pub singular_values: Vec<f64>,
    /// Fit of the model's response to the window, 100 (1 - |y - yh| / |y - mean y|); `null` for a constant record.
    pub fit_percent: Option<f64>,
    /// Root mean square error of the response, unit of the channel.
    pub rmse: Option<f64>,
    /// The sentences of `remarks`, `warning: ` in front where it may change a conclusion: what programs of before read.
    pub notes: Vec<String>,
    /// Fit of every output where there are several, in the order of `channel`; `fit_percent` is then the smallest.
    #[serde(default)]
    pub output_fits_percent: Vec<Option<f64>>,
    /// Time by which the input acts late, s; `null`: no delay.
    pub delay_s: Option<f64>,
    /// Channels that drive the model; empty: none does, or an earlier artifact does not say it.
    #[serde(default)]
    pub inputs: Vec<String>,
    /// What a reader should know; empty: nothing, or an earlier artifact has it in `notes` alone.
    #[serde(default)]
    pub remarks: Vec<RemarkV1>,
}

// Records: identified models (state space, transfer function, exponential sum) and their modes.

/// A linear state-space model. Topic `/model/<id>`. Matrices are lists of rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ExponentialSumV1 {
    /// Terms; a real signal has them real or in conjugate pairs.
    pub terms: Vec<ExponentialTermV1>,
    /// What the sum describes, in words.
    pub output: String,
}

/// `(re_amplitude + i im_amplitude) exp((re_per_s + i im_rad_per_s) t)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ModesV2 {
    /// One entry a pole that is a mode.
    pub modes: Vec<ModeV1>,
    /// The poles of the model that are no modes.
    #[serde(default)]
    pub other_poles: Vec<OtherPoleV1>,
}

/// A pole that is no mode of the record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum OtherPoleKindV1 {
    /// At or near zero: the model integrates.
    Integrator,
    /// At or beyond the Nyquist frequency of the record.
    BeyondNyquist,
    /// A zero cancels it: a model without it fits as well.
    Cancelled,
    /// The line of a machine that runs.
    Harmonic,
}

/// Modes of a model as they were written before: a JSON array.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(transparent)]
pub struct ModesV1(pub Vec<ModeV1>);

impl From<ModesV1> for ModesV2 {
    fn from(earlier: ModesV1) -> Self {
        Self { modes: earlier.0, other_poles: Vec::new() }
    }
}

/// One mode of a model, continuous time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
    /// What it is; `null` in earlier artifacts.
    pub kind: Option<ModeKindV1>,
}

/// What a pole is that is neither an integrator nor beyond the Nyquist frequency.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ModeKindV1 {
    /// It grows.
    Growing,
    /// It decays without oscillating.
    Real,
    /// A damped oscillation.
    Mode,
}

// Record: responses of an identified model.

/// Responses of an identified model, ready to be drawn. Topic `/response/<id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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

//! Record: validation of an identified model.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Validation of an identified model beyond its fit. Topic `/evidence/<id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
    /// Whether the model holds on the samples kept for validation, run on and with its state fitted to them: a fit of
    /// at least 0, and at most 30 points below that of the samples of this output that it was identified from. `null`:
    /// it has seen all.
    #[serde(default)]
    pub holds_on_unseen: Option<bool>,
}

/// Spread of a number over the replicates of a bootstrap.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpreadV1 {
    /// Standard deviation.
    pub deviation: f64,
    /// 5 % of the replicates lie below.
    pub lower: f64,
    /// 5 % lie above.
    pub upper: f64,
}

//! Records of identify about several models or about the record itself: scans, comparisons, checks, shapes, diagrams.

use serde::{Deserialize, Serialize};

use crate::records::identified::NoiseModelV1;

// Record: ARX structures compared.

/// ARX models of many structures, compared on the same equations. Topic `/scan/<output channel>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ArxScanV1 {
    /// Channels that drive the models, separated by commas.
    pub input: String,
    /// Channel they answer with.
    pub output: String,
    /// Number of equations that every model is compared on.
    pub samples: u64,
    /// The models, the fewest past outputs first, then the fewest inputs, then the shortest delay.
    pub models: Vec<ArxScanModelV1>,
    /// Id of the model with the smallest BIC, `arx-<past outputs>-<inputs>-<delay>`.
    pub best_by_bic: Option<String>,
    /// Id of the model with the smallest AICc.
    pub best_by_aicc: Option<String>,
    /// Numbers of the best by BIC that stand at the end of their range, which was wider than one number: a wider scan
    /// may find a better model.
    #[serde(default)]
    pub at_edge: Vec<ScanEdgeV1>,
}

/// A number of an ARX structure that stands at the end of its range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ScanEdgeV1 {
    /// That of past outputs.
    PastOutputs,
    /// That of samples of every input.
    Inputs,
    /// That of samples between an input and its first effect.
    Delay,
}

/// One structure of a scan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ArxScanModelV1 {
    /// Number of past outputs.
    pub past_outputs: u64,
    /// Number of samples of every input.
    pub inputs: u64,
    /// Samples between an input and its first effect.
    pub delay: u64,
    /// Number of coefficients.
    pub parameters: u64,
    /// Mean square of the one-step prediction errors, square of the output's unit; `null` where the fit failed.
    pub loss: Option<f64>,
    /// Akaike's criterion for short records, of the prediction errors.
    pub aicc: Option<f64>,
    /// Schwarz's criterion, likewise.
    pub bic: Option<f64>,
    /// Minimum description length, likewise, square of the output's unit.
    pub mdl: Option<f64>,
    /// Fit of the simulated output with the best initial state, percent; `null` for a model whose output overflows.
    pub fit_percent: Option<f64>,
    /// Why there is no model.
    pub failure: Option<String>,
}

// Record: models of one output compared.

/// Models of one output compared: which of them the record prefers, and which it does not distinguish. Topic
/// `/selection/<output channel>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct SelectionV1 {
    /// Channel that the models answer with; several separated by commas, in the topic by `+`.
    pub output: String,
    /// Number of independent samples that all of them are compared on.
    pub effective_samples: f64,
    /// The models, the smallest criterion first.
    pub models: Vec<SelectionModelV1>,
    /// Id with the smallest AICc.
    pub best_by_aicc: String,
    /// Id with the smallest BIC.
    pub best_by_bic: String,
    /// Id with the best fit of the samples kept for validation, if any were.
    pub best_by_validation: Option<String>,
    /// Ids within 2 of the smallest AICc: the record does not distinguish them. The best itself is among them.
    pub near_equal: Vec<String>,
    /// Id of the model to use; of `/identification` and `/evidence` too.
    pub recommended: Option<String>,
    /// Why it is that one.
    pub recommended_because: Option<RecommendedBecauseV1>,
    /// The model with the smallest BIC, where another one is recommended.
    pub passed_over: Option<String>,
}

/// Why a model is recommended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum RecommendedBecauseV1 {
    /// It has the smallest BIC.
    SmallestBic,
    /// The one with the smallest BIC has a single state, and models of higher order follow unseen samples better by two
    /// points or more: of these it has the smallest BIC.
    ValidatesBetter,
}

/// One model of a comparison.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct SelectionModelV1 {
    /// Id of the model.
    pub id: String,
    /// Number of its parameters.
    pub parameters: u64,
    /// Mean square error of the simulated output; of several outputs the geometric mean.
    pub loss: f64,
    /// Akaike's criterion for short records less that of the best; `null` with too many parameters.
    pub aicc_difference: Option<f64>,
    /// Schwarz's criterion less that of the best.
    pub bic_difference: f64,
    /// Fit of the samples kept for validation, percent.
    pub validation_fit_percent: Option<f64>,
    /// Number of states; `null` in earlier artifacts.
    pub order: Option<u32>,
    /// Fit of the samples kept for validation with the start fitted, percent, mean over the outputs.
    pub validation_restarted_fit_percent: Option<f64>,
}

// Record: what the samples themselves show

/// What the waveforms of a run show before any method: what is left out, how late the inputs act, trends and outliers.
/// Topic `/checks/<outputs>`, several outputs separated by `+`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct RecordChecksV1 {
    /// Constant inputs, which the methods run without.
    pub inputs_left_out: Vec<String>,
    /// The delay as `--delay auto` found it; `null` where it was given.
    pub delay: Option<FoundDelayV1>,
    /// Poles of the output-error models that trends and outliers were looked for with; `null`: they were not.
    pub order: Option<u32>,
    /// Outputs whose level follows a straight line.
    pub trends: Vec<TrendV1>,
    /// Outputs with samples that no model of the order explains.
    pub outliers: Vec<OutliersV1>,
}

/// How late the inputs act.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct FoundDelayV1 {
    /// Samples between an input and its effect, the number that `--delay` takes.
    pub samples: u32,
    /// Smallest delay that was tried.
    pub first: u32,
    /// Largest.
    pub last: u32,
    /// Whether it is the largest or, above 0, the smallest that was tried: it may lie beyond.
    pub at_edge: bool,
    /// Noise model that decided.
    pub noise: NoiseModelV1,
}

/// A straight line that an output follows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct TrendV1 {
    /// The output.
    pub channel: String,
    /// Slope of the straight line through it, its unit per second.
    pub slope_per_s: f64,
    /// By how much the BIC falls without the straight lines.
    pub bic_gain: f64,
}

/// Samples of an output that stand out of the errors of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct OutliersV1 {
    /// The output.
    pub channel: String,
    /// Their numbers, from the start of the window.
    pub samples: Vec<u64>,
    /// Their times, s.
    pub times_s: Vec<f64>,
}

// Record: mode shapes over the sensors.

/// Mode shapes of one model over several sensors. Topic `/shapes/<id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ShapesV1 {
    /// Channels, in the order of the entries of a shape.
    pub channels: Vec<String>,
    /// One entry for every mode, conjugates once, in the order of `/modes/<id>`.
    pub shapes: Vec<ShapeV1>,
    /// Modal assurance criterion between each two shapes, 0 to 1; its rows are as many as the shapes.
    pub modal_assurance: Vec<Vec<f64>>,
}

/// Shape of one mode: relative motion of the sensors, the largest entry 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ShapeV1 {
    /// Real part of the pole, 1/s.
    pub re_per_s: f64,
    /// Imaginary part, rad/s.
    pub im_rad_per_s: f64,
    /// Real parts, one entry a channel.
    pub re: Vec<f64>,
    /// Imaginary parts: what is out of phase.
    pub im: Vec<f64>,
    /// Modal phase collinearity: 1 if all sensors move in phase or against it, 0 if phases are spread all round.
    pub phase_collinearity: Option<f64>,
}

// Record: stabilisation diagram, poles over the model order.

/// Poles of models of rising order, and the clusters they form. Topic `/stabilisation/<method>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct StabilizationV1 {
    /// Method of the models, e.g. `era`.
    pub method: String,
    /// Channel they were identified from.
    pub channel: String,
    /// Orders, rising.
    pub orders: Vec<u32>,
    /// Largest damping ratio of a pole that counts.
    pub highest_damping: f64,
    /// Share of the Nyquist frequency above which a pole does not count.
    pub nyquist_share: f64,
    /// Least modal phase collinearity of a shape; `null` with one sensor.
    pub least_collinearity: Option<f64>,
    /// Least energy of a pole's wave in the record, over that of the strongest wave in noise like the residual; `null`
    /// where the method does not give it.
    pub least_strength: Option<f64>,
    /// Relative change of frequency up to which a pole is stable.
    pub frequency_change: f64,
    /// Relative change of the damping ratio, likewise.
    pub damping_change: f64,
    /// `1 - MAC`, likewise; `null` with one sensor.
    pub shape_change: Option<f64>,
    /// Share of the orders in which a cluster is present.
    pub presence: f64,
    /// Oscillating poles, the upper of each pair, by order and frequency.
    pub poles: Vec<StabilizationPoleV1>,
    /// Clusters, by frequency.
    pub clusters: Vec<StabilizationClusterV1>,
    /// Clusters that were left out because not both halves of the record show them; `null` where the halves were not
    /// looked at.
    pub not_in_both_halves: Option<u32>,
}

/// One pole of a stabilisation diagram.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct StabilizationPoleV1 {
    /// Order of its model.
    pub order: u32,
    /// Real part, 1/s.
    pub re_per_s: f64,
    /// Imaginary part, rad/s.
    pub im_rad_per_s: f64,
    /// `rejected`, `new`, `frequency`, `frequency-and-damping` or `all`.
    pub stability: String,
}

/// A mode that many orders agree on: medians and quartiles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct StabilizationClusterV1 {
    /// Number of orders in which it is present.
    pub orders: u32,
    /// Natural frequency, rad/s, median.
    pub natural_frequency_rad_per_s: f64,
    /// Its lower quartile.
    pub natural_frequency_lower_rad_per_s: f64,
    /// Its upper quartile.
    pub natural_frequency_upper_rad_per_s: f64,
    /// Damping ratio, median.
    pub damping_ratio: f64,
    /// Its lower quartile.
    pub damping_ratio_lower: f64,
    /// Its upper quartile.
    pub damping_ratio_upper: f64,
    /// Natural frequency in the first and in the second half of the record, rad/s; empty where the halves were not
    /// looked at.
    #[serde(default)]
    pub halves_rad_per_s: Vec<f64>,
    /// Mean shape over the channels, real parts, the largest entry 1; empty where it is not known.
    #[serde(default)]
    pub shape_re: Vec<f64>,
    /// Its imaginary parts.
    #[serde(default)]
    pub shape_im: Vec<f64>,
}

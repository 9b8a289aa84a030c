//! Record: ARX structures compared.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// ARX models of many structures, compared on the same equations. Topic `/scan/<output channel>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
}

/// One structure of a scan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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

//! Record: models of one output compared.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Models of one output compared: which of them the record prefers, and which it does not distinguish. Topic
/// `/selection/<output channel>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
}

/// One model of a comparison.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
}

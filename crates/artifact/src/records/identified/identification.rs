//! Record: how a model was identified and how well it fits.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a model was identified and how well it fits. Topic `/identification/<id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct IdentificationV1 {
    /// Method, e.g. `era`.
    pub method: String,
    /// Model order (number of states).
    pub order: u32,
    /// Channel the model was identified from; several outputs separated by ", ".
    pub channel: String,
    /// What the samples were taken for: `impulse-response` or `free-decay`.
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
    /// What a reader should know.
    pub notes: Vec<String>,
    /// Fit of every output where there are several, in the order of `channel`; `fit_percent` is then the smallest.
    #[serde(default)]
    pub output_fits_percent: Vec<Option<f64>>,
    /// Time by which the input acts late, s; `null`: no delay.
    pub delay_s: Option<f64>,
}

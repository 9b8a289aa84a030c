use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The response of one candidate beside the test. Topic `/simulation/<candidate id>`.
///
/// Errors are taken over the window `from_s`..`to_s` after time zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SimulationV1 {
    /// Dynamic crush of the model, m; `null` if its velocity never reaches zero.
    pub dynamic_crush_m: Option<f64>,
    /// Time of dynamic crush, s.
    pub time_of_dynamic_crush_s: Option<f64>,
    /// Root mean square displacement error, m.
    pub rmse_displacement_m: Option<f64>,
    /// Displacement fit, 100 (1 - |x - xh| / |x - mean x|).
    pub fit_percent: Option<f64>,
    /// ISO/TS 18571 score of the acceleration, 0 to 1, where computed.
    pub iso18571_score: Option<f64>,
    /// Crush of the model minus crush of the test, m.
    pub dynamic_crush_error_m: Option<f64>,
    /// Time of crush of the model minus that of the test, s.
    pub time_of_dynamic_crush_error_s: Option<f64>,
    /// Largest displacement error, m.
    pub max_displacement_error_m: Option<f64>,
    /// Fit of velocity, percent.
    pub fit_velocity_percent: Option<f64>,
    /// Fit of acceleration, percent.
    pub fit_acceleration_percent: Option<f64>,
    /// Compared window: start, s after time zero.
    pub from_s: f64,
    /// Compared window: end.
    pub to_s: f64,
    /// What a reader should know.
    #[serde(default)]
    pub notes: Vec<String>,
}

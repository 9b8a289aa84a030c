//! Record: stabilisation diagram, poles over the model order.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Poles of models of rising order, and the clusters they form. Topic `/stabilisation/<method>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
}

/// One pole of a stabilisation diagram.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
}

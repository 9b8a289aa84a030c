//! Record: a candidate in a test that was not made.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a candidate says of an impact at another speed or with another mass. Topic `/prediction/<n>`, n = 1, 2, ...
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PredictionV1 {
    /// Candidate.
    pub candidate: String,
    /// Whether it is the one recommended for predictions.
    pub recommended: bool,
    /// Names it has in the choice of candidates: `recommended`, `simplest`, `closest`.
    #[serde(default)]
    pub names: Vec<String>,
    /// Impact speed, m/s.
    pub impact_speed_m_per_s: f64,
    /// Mass of the vehicle, kg.
    pub mass_kg: f64,
    /// What it meets; `null`: the rigid wall of the test.
    pub partner: Option<String>,
    /// Dynamic crush, m; `null` if the model never stops.
    pub dynamic_crush_m: Option<f64>,
    /// Time of dynamic crush, s after contact.
    pub time_of_dynamic_crush_s: Option<f64>,
    /// Change of velocity up to the rebound, m/s.
    pub delta_v_m_per_s: Option<f64>,
    /// Rebound velocity of the compartment over the impact speed.
    pub coefficient_of_restitution: Option<f64>,
    /// Largest deceleration of the compartment through CFC 60, m/s².
    pub peak_acceleration_m_per_s2: Option<f64>,
    /// Occupant load criterion, m/s².
    pub olc_m_per_s2: Option<f64>,
    /// Where the energy goes.
    pub energy: Option<PredictedEnergyV1>,
    /// Whether the model is asked beyond what was tested; a note says by how much and by what rule it goes on.
    pub extrapolates: bool,
    /// Intervals.
    #[serde(default)]
    pub intervals: Vec<PredictedIntervalV1>,
    /// What a reader should know.
    #[serde(default)]
    pub notes: Vec<String>,
    /// The prediction beside a test that was made.
    #[serde(default)]
    pub against: Option<AgainstTestV1>,
}

/// Where the energy of an impact goes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PredictedEnergyV1 {
    /// Kinetic energy of all masses at contact, J.
    pub kinetic_at_impact_j: f64,
    /// Kinetic energy of all masses when the compartment stops, J.
    pub kinetic_at_rest_j: f64,
    /// Taken by the structure until then, stored or not, J.
    pub absorbed_j: f64,
}

/// An interval of a predicted number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PredictedIntervalV1 {
    /// Field of the prediction, e.g. `dynamic_crush_m`.
    pub name: String,
    /// Share of cases that it is to hold, e.g. 0.9.
    pub level: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// What is in it, with its share of the variance, in words.
    pub interval_by: String,
}

/// A prediction beside a test that was made.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AgainstTestV1 {
    /// Title of the test.
    pub test: String,
    /// Predicted less measured dynamic crush, percent of the measured.
    pub dynamic_crush_error_percent: Option<f64>,
    /// Predicted less measured time of dynamic crush, percent of the measured.
    pub time_of_dynamic_crush_error_percent: Option<f64>,
    /// Predicted less measured peak, percent of the measured.
    pub peak_acceleration_error_percent: Option<f64>,
    /// Predicted less measured coefficient of restitution.
    pub coefficient_of_restitution_error: Option<f64>,
    /// Score of the predicted acceleration by ISO/TS 18571, 0 to 1.
    pub iso18571_score: Option<f64>,
    /// Names of the intervals that hold the measured value.
    #[serde(default)]
    pub held: Vec<String>,
}

//! Records of predict: impacts that were not made.

use serde::{Deserialize, Serialize};

// Record: a candidate in a test that was not made.

/// What a candidate says of an impact at another speed or with another mass. Topic `/prediction/<n>`, n = 1, 2, ...
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct PredictionV1 {
    /// Candidate.
    pub candidate: String,
    /// Whether it is the one recommended for predictions.
    pub recommended: bool,
    /// Names it has in the choice of candidates: `recommended`, `simplest`, `closest`.
    #[serde(default)]
    pub names: Vec<String>,
    /// Impact speed over ground, m/s.
    pub impact_speed_m_per_s: f64,
    /// Mass of the vehicle, kg.
    pub mass_kg: f64,
    /// What it meets; `null`: the rigid wall of the test.
    pub partner: Option<String>,
    /// Dynamic crush, m, against a partner that of the vehicle at common velocity; `null` if the model never stops.
    pub dynamic_crush_m: Option<f64>,
    /// Time of dynamic crush, s after contact.
    pub time_of_dynamic_crush_s: Option<f64>,
    /// Change of velocity up to the rebound, m/s.
    pub delta_v_m_per_s: Option<f64>,
    /// Rebound velocity of the compartment over the impact speed; against a partner both relative to it.
    pub coefficient_of_restitution: Option<f64>,
    /// Largest deceleration of the compartment through CFC 60, m/s².
    pub peak_acceleration_m_per_s2: Option<f64>,
    /// Who answers for the peak; `null` where the record of the test shows none.
    #[serde(default)]
    pub peak_by: Option<AnsweredByV1>,
    /// Who answers for the restitution and with it for the change of velocity; `null` where the record shows none.
    #[serde(default)]
    pub delta_v_by: Option<AnsweredByV1>,
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
    /// What the collision with a partner makes of both; `null`: the wall.
    #[serde(default)]
    pub collision: Option<PredictedCollisionV1>,
    /// What becomes of the occupant; `null`: none was asked for.
    #[serde(default)]
    pub occupant: Option<PredictedOccupantV1>,
    /// Whether a person asked for this impact, beside the standing ones of the pipeline.
    #[serde(default)]
    pub asked: bool,
}

/// Who answers for a predicted number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum AnsweredByV1 {
    /// The record of the test, within what was tested: its number is carried to the asked impact by the model.
    Record,
    /// The model, beyond what was tested; what it misses in its own test is taken out.
    Model,
}

/// Where the energy of an impact goes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct PredictedEnergyV1 {
    /// Kinetic energy of all masses at contact, J; those of a partner among them.
    pub kinetic_at_impact_j: f64,
    /// Kinetic energy of all masses when the compartment stops, or has the velocity of the partner's, J.
    pub kinetic_at_rest_j: f64,
    /// Taken by the structures until then, stored or not, J.
    pub absorbed_j: f64,
}

/// A collision with another vehicle or a moving barrier. Velocities are over ground, positive in the direction of the
/// vehicle; a change of velocity is a size.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct PredictedCollisionV1 {
    /// What the partner is: `vehicle` or `barrier`.
    pub kind: String,
    /// Candidate of the partner's run; `null` of a barrier.
    pub partner_candidate: Option<String>,
    /// Speed at which they approach, m/s.
    pub closing_speed_m_per_s: f64,
    /// Speed of the partner towards the vehicle, m/s.
    pub partner_speed_m_per_s: f64,
    /// Mass of the partner, kg.
    pub partner_mass_kg: f64,
    /// Velocity of both compartments at the time of dynamic crush, m/s.
    pub common_velocity_m_per_s: Option<f64>,
    /// Crush of both then, m.
    pub mutual_crush_m: Option<f64>,
    /// What of it is the partner's, m.
    pub partner_crush_m: Option<f64>,
    /// Change of the partner's velocity up to the parting, m/s.
    pub partner_delta_v_m_per_s: Option<f64>,
    /// Largest deceleration of the partner's compartment through CFC 60, m/s².
    pub partner_peak_acceleration_m_per_s2: Option<f64>,
    /// Occupant load criterion of the partner, m/s².
    pub partner_olc_m_per_s2: Option<f64>,
    /// Energy that the vehicle has taken until common velocity, J.
    pub absorbed_j: Option<f64>,
    /// Energy that the partner has taken, J.
    pub partner_absorbed_j: Option<f64>,
    /// Speed at which the mass of the vehicle has the energy it has taken, m/s.
    pub energy_equivalent_speed_m_per_s: Option<f64>,
    /// The same of the partner, m/s.
    pub partner_energy_equivalent_speed_m_per_s: Option<f64>,
    /// Velocity of the vehicle after the parting, m/s.
    pub velocity_after_m_per_s: Option<f64>,
    /// Velocity of the partner after it, m/s.
    pub partner_velocity_after_m_per_s: Option<f64>,
    /// Momentum of all masses before, N·s.
    pub momentum_before_n_s: f64,
    /// Momentum of all masses after, N·s.
    pub momentum_after_n_s: f64,
}

/// An occupant behind a restraint in the compartment.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct PredictedOccupantV1 {
    /// When the slack is used up, s after contact.
    pub time_of_contact_s: Option<f64>,
    /// Speed ahead of the compartment then, m/s.
    pub relative_speed_at_contact_m_per_s: Option<f64>,
    /// Largest deceleration, m/s².
    pub peak_acceleration_m_per_s2: f64,
    /// Its time, s after contact.
    pub time_of_peak_s: f64,
    /// Largest way ahead of the compartment, m.
    pub largest_excursion_m: f64,
    /// Its time, s after contact.
    pub time_of_largest_excursion_s: f64,
    /// Share of the occupant's energy that crush of the vehicle takes, until the occupant stops over ground, or has
    /// the common velocity; `null`: it does not stop.
    pub ride_down_share: Option<f64>,
    /// Share that the restraint takes.
    pub restraint_share: Option<f64>,
}

/// An interval of a predicted number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct PredictedIntervalV1 {
    /// Field of the prediction, e.g. `dynamic_crush_m` or `collision.mutual_crush_m`.
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

/// An error of the crush that an engineer calls none, percent: that of two sensors in one car.
const ALIKE_PERCENT: f64 = 3.0;

impl AgainstTestV1 {
    /// The error of the crush, percent, where the measured one is outside of its interval and further off than two
    /// sensors in one car are.
    pub fn missed_crush_percent(&self) -> Option<f64> {
        let is_held = self.held.iter().any(|name| name == "dynamic_crush_m");
        self.dynamic_crush_error_percent.filter(|error| !is_held && error.abs() > ALIKE_PERCENT)
    }
}

/// A prediction beside a test that was made.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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

//! Record: the motion of a candidate beside the test.

use serde::{Deserialize, Serialize};

/// The response of one candidate beside the test. Topic `/simulation/<candidate id>`.
///
/// Errors are taken over the window `from_s`..`to_s` after time zero.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
    /// Of an earlier version: corrected Akaike criterion of the displacement error. The criterion of a candidate is
    /// that of `/recommendation`.
    pub aicc: Option<f64>,
    /// Of an earlier version: independent samples in it.
    pub effective_samples: Option<f64>,
    /// Of an earlier version: parameters in it.
    pub fitted_parameters: Option<u32>,
    /// The candidate beside other sensors on the vehicle, which its fit did not see.
    #[serde(default)]
    pub other_sensors: Vec<OtherSensorV1>,
    /// What moved the model where it was not the impact alone, in words.
    #[serde(default)]
    pub drive: Option<String>,
    /// Energy at the start, at dynamic crush and at the end.
    #[serde(default)]
    pub energy: Vec<EnergyV1>,
    /// Largest gap of the energy balance over the whole response, relative to its largest term.
    #[serde(default)]
    pub energy_closure: Option<f64>,
    /// Ratings of the model's curves against the test's.
    #[serde(default)]
    pub ratings: Vec<RatingV1>,
    /// Displacement fit as `fit_percent`, of the model sampled, filtered and integrated as the record was: a true model
    /// reaches 100 on a record without noise. `null` under a drive.
    #[serde(default)]
    pub fit_as_measured_percent: Option<f64>,
    /// Misfit of the force on the wall, percent of its root mean square from contact to separation, the force of the
    /// model filtered as that measured; `null` without a measured force, or under a drive.
    #[serde(default)]
    pub force_misfit_percent: Option<f64>,
    /// Restitution of the model, `-v/v0` of its compartment where its acceleration first passes zero after the crush,
    /// where a real contact opens; `null` under a drive.
    #[serde(default)]
    pub coefficient_of_restitution: Option<f64>,
    /// Velocity of the compartment there, m/s, negative.
    #[serde(default)]
    pub rebound_velocity_m_per_s: Option<f64>,
    /// Largest deceleration of the model's compartment through CFC 60, m/s², negative as in the record; `null` where
    /// the record is too coarse for that class.
    #[serde(default)]
    pub peak_acceleration_m_per_s2: Option<f64>,
    /// What the model leaves of the measured acceleration; `null` without a measured one, or where nothing is left.
    #[serde(default)]
    pub residual: Option<ResidualV1>,
    /// How far the motion of the recommended candidate moves with its parameters; `null` of any other, under a drive,
    /// and where the record leaves a parameter open.
    #[serde(default)]
    pub band: Option<MotionBandV1>,
}

/// Acceleration of the test less that of a model over the compared window. The model's is that of its motion, the
/// test's went through the filter: what the filter takes from the model is part of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ResidualV1 {
    /// Root mean square, m/s².
    pub rms_m_per_s2: f64,
    /// That over the root mean square of the test.
    pub share_of_test: f64,
    /// Samples compared.
    pub samples: u64,
    /// Distance of the lags, s.
    pub lag_s: f64,
    /// Autocorrelation at the lags 0, 1, ... up to a quarter of the window, at most 301 of them.
    pub autocorrelation: Vec<f64>,
    /// 95 % limits of the autocorrelation of white noise of so many samples: `1.96/sqrt(N)` to either side of zero.
    pub limit: f64,
    /// Share of the lags from 1 on that lie outside the limits; of white noise one in twenty does.
    pub share_outside: f64,
}

/// Half-widths of the 95 % band about the motion of a model's compartment, from contact to the end of the compared
/// window.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct MotionBandV1 {
    /// Distance of the instants, s.
    pub dt_s: f64,
    /// Of the displacement, m.
    pub displacement_m: Vec<f64>,
    /// Of the velocity, m/s.
    pub velocity_m_per_s: Vec<f64>,
}

/// One rating of a curve of the model against the test's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct RatingV1 {
    /// Name, e.g. `cora`.
    pub name: String,
    /// What was compared: `acceleration`, `displacement`.
    pub quantity: String,
    /// Value, a ratio; `null` where it is not defined or was not computed, and `note` says why.
    pub value: Option<f64>,
    /// Key of the definition in the catalogue of `docs/metrics.md`, e.g. `cora`.
    pub definition_id: String,
    /// How well that definition is known: `C`, `S`, `M` or `U`.
    pub mark: String,
    /// Rated window: start, s after time zero; `null` without a value.
    pub from_s: Option<f64>,
    /// Rated window: end.
    pub to_s: Option<f64>,
    /// What the definition leaves open and was chosen, the grade, or why there is no value.
    pub note: Option<String>,
}

/// A candidate beside a sensor that its fit did not see.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct OtherSensorV1 {
    /// Channel.
    pub channel: String,
    /// Mass of the model it was compared with, counted from the barrier, from 1.
    pub mass: u32,
    /// Root mean square displacement error over the window, m.
    pub rmse_displacement_m: f64,
    /// Displacement fit, percent.
    pub fit_percent: Option<f64>,
}

/// Where the energy of a model is at one instant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct EnergyV1 {
    /// `start`, `dynamic crush` (the sample next to it) or `end`.
    pub instant: String,
    /// Time after time zero, s.
    pub time_s: f64,
    /// In the masses, J.
    pub kinetic_j: f64,
    /// In the springs, J: what they can give back.
    pub stored_j: f64,
    /// Turned into heat by dampers and plastic deformation, J.
    pub dissipated_j: f64,
    /// Brought in by the impact speed, a force or a moving barrier, J.
    pub input_j: f64,
}

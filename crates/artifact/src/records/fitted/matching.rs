//! Record: coefficient matching, from an identified model to masses, springs and dampers.

use serde::{Deserialize, Serialize};

/// Every parameter set of the double model with the characteristic polynomial of an identified one. Topic
/// `/matching/<model id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct MatchingV1 {
    /// Mass of the chassis, kg.
    pub m1_kg: f64,
    /// Mass of the compartment, kg.
    pub m2_kg: f64,
    /// The polynomial, highest power of s first, the first is 1.
    pub polynomial: Vec<f64>,
    /// Bound of m2/m1 below which all parameters can be positive; `null` if no masses allow it.
    pub largest_mass_ratio: Option<f64>,
    /// Roots `c1 c2/(m1 m2)` of the cubic, 1/s², real ones first.
    pub roots: Vec<MatchingRootV1>,
    /// All solutions, real ones first; multiplicities sum to six.
    pub solutions: Vec<MatchingSolutionV1>,
    /// The real solutions over the division of the same total mass.
    pub sweep: Vec<MatchingSweepV1>,
    /// What was found, in words.
    pub notes: Vec<String>,
    /// What of the model was used, in words: coefficients of a transfer function, eigenvalues of a state matrix, ...
    #[serde(default)]
    pub source: Option<String>,
    /// `c1 c2/(m1 m2)` that the start of a free motion implies, 1/s²: it distinguishes pairs of solutions.
    #[serde(default)]
    pub zeta_of_the_start_per_s2: Option<f64>,
    /// A state space in the coordinates of every real solution.
    #[serde(default)]
    pub coordinates: Vec<PhysicalCoordinatesV1>,
}

/// An identified state space in the coordinates `(x1, x2, v1, v2)` of one solution, `M x'' + L x' + K x = 0`; matrices
/// are lists of rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct PhysicalCoordinatesV1 {
    /// The candidate.
    pub candidate: String,
    /// `M`, kg.
    pub mass_kg: Vec<Vec<f64>>,
    /// `L`, N·s/m.
    pub damping_n_s_per_m: Vec<Vec<f64>>,
    /// `K`, N/m.
    pub stiffness_n_per_m: Vec<Vec<f64>>,
    /// `T` of `(x1, x2, v1, v2) = T z`, z the state of the model.
    pub transformation: Vec<Vec<f64>>,
    /// Condition number of `T`, velocities over the mean natural frequency.
    pub condition: f64,
    /// `|T A - Ap T|/|Ap T|`.
    pub residual: f64,
    /// Difference of the chassis row of `T` from that of a sensor there, relative; `null` without one.
    pub chassis_mismatch: Option<f64>,
    /// `(x1, x2, v1, v2)` at the start of a free motion, m and m/s.
    pub start: Option<Vec<f64>>,
}

/// One root of the cubic.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct MatchingRootV1 {
    /// Real part.
    pub re_per_s2: f64,
    /// Imaginary part.
    pub im_per_s2: f64,
    /// How often it counts.
    pub multiplicity: u32,
    /// Radius within which an exact root is proved to lie; `null` at a multiple root.
    pub certified_radius_per_s2: Option<f64>,
}

/// One solution; imaginary parts are 0 for a real one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct MatchingSolutionV1 {
    /// Spring between barrier and chassis.
    pub k1_re_n_per_m: f64,
    /// Its imaginary part.
    pub k1_im_n_per_m: f64,
    /// Spring between chassis and compartment.
    pub k2_re_n_per_m: f64,
    /// Its imaginary part.
    pub k2_im_n_per_m: f64,
    /// Damper between barrier and chassis.
    pub c1_re_n_s_per_m: f64,
    /// Its imaginary part.
    pub c1_im_n_s_per_m: f64,
    /// Damper between chassis and compartment.
    pub c2_re_n_s_per_m: f64,
    /// Its imaginary part.
    pub c2_im_n_s_per_m: f64,
    /// Whether all four are real.
    pub real: bool,
    /// Whether all four are real and positive.
    pub physical: bool,
    /// How often it counts.
    pub multiplicity: u32,
    /// Place of the dual solution in the list, from 0.
    pub dual: u32,
    /// Largest relative mismatch of the four equations.
    pub residual: f64,
    /// Id of the candidate, for a real solution.
    pub candidate: Option<String>,
    /// Zero `-k2/c2` of the transfer function from a force on the chassis to the compartment, 1/s: real part.
    #[serde(default)]
    pub zero_re_per_s: Option<f64>,
    /// Its imaginary part.
    #[serde(default)]
    pub zero_im_per_s: Option<f64>,
}

/// One real solution at one division of the mass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct MatchingSweepV1 {
    /// m1/(m1 + m2).
    pub front_mass_fraction: f64,
    /// Spring between barrier and chassis.
    pub k1_n_per_m: f64,
    /// Spring between chassis and compartment.
    pub k2_n_per_m: f64,
    /// Damper between barrier and chassis.
    pub c1_n_s_per_m: f64,
    /// Damper between chassis and compartment.
    pub c2_n_s_per_m: f64,
    /// Whether all four are positive.
    pub physical: bool,
}

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Every parameter set of the double model with the characteristic polynomial of an identified one. Topic
/// `/matching/<model id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
}

/// One root of the cubic.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
}

/// One real solution at one division of the mass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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

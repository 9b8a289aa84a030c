//! Record: the vehicles of a test with several.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The vehicles of a test in which two meet. Topic `/vehicles`; not there where the file states one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VehiclesV1 {
    /// In the order of the file. The one with the pulse of `/test` has the mass and the speed stated there.
    pub vehicles: Vec<VehicleV1>,
    /// Speed at which they approach each other, m/s, as the file states it.
    pub closing_speed_m_per_s: Option<f64>,
}

/// One vehicle of several.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VehicleV1 {
    /// Number by which the file names it.
    pub number: u32,
    /// In words.
    pub description: Option<String>,
    /// Test mass, kg.
    pub mass_kg: Option<f64>,
    /// Speed just before contact, m/s; 0: it stands.
    pub impact_speed_m_per_s: Option<f64>,
    /// The channel that serves best as its pulse, where one does.
    pub pulse: Option<String>,
    /// Ids of all channels on it and in it.
    pub channels: Vec<String>,
}

//! Record: what was measured on the vehicle after the test.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Residual crush of the vehicle, as the file of the test states it. Topic `/damage`; not there where it states none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DamageV1 {
    /// Residual crush at stations of equal spacing over the width of the damage, left to right, m; negative: the
    /// structure bulges out.
    pub residual_crush_m: Vec<f64>,
    /// Width of the damage, m; `null`: not stated.
    pub damage_width_m: Option<f64>,
    /// Width of the vehicle, m.
    pub vehicle_width_m: Option<f64>,
    /// Collision deformation classification (SAE J224), e.g. `12FDEW2`.
    pub classification: Option<String>,
    /// The fields of the file that these are from.
    pub from: String,
}

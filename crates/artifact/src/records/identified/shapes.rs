//! Record: mode shapes over the sensors.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Mode shapes of one model over several sensors. Topic `/shapes/<id>`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShapesV1 {
    /// Channels, in the order of the entries of a shape.
    pub channels: Vec<String>,
    /// One entry for every mode, conjugates once, in the order of `/modes/<id>`.
    pub shapes: Vec<ShapeV1>,
    /// Modal assurance criterion between each two shapes, 0 to 1; its rows are as many as the shapes.
    pub modal_assurance: Vec<Vec<f64>>,
}

/// Shape of one mode: relative motion of the sensors, the largest entry 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShapeV1 {
    /// Real part of the pole, 1/s.
    pub re_per_s: f64,
    /// Imaginary part, rad/s.
    pub im_rad_per_s: f64,
    /// Real parts, one entry a channel.
    pub re: Vec<f64>,
    /// Imaginary parts: what is out of phase.
    pub im: Vec<f64>,
    /// Modal phase collinearity: 1 if all sensors move in phase or against it, 0 if phases are spread all round.
    pub phase_collinearity: Option<f64>,
}

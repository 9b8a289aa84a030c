//! Linear regression on past outputs and inputs: ARX of one output and of several.
//! May use modes, data, error.

pub(crate) mod arx;
pub(crate) mod vector_arx;

//! Linear regression on past outputs and inputs: ARX of one output and of several.

pub(crate) mod arx;
pub(crate) mod vector_arx;

//! Continuous transfer functions of one or several inputs and outputs.

pub(crate) mod array;
pub(crate) mod fit;

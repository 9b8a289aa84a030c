//! Continuous transfer functions of one or several inputs and outputs.
//! May use poles, simulation, modes, data, error.

pub(crate) mod array;
pub(crate) mod fit;

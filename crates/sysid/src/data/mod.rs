//! What every method starts from: inputs and outputs sampled together, Markov parameters, parts and thinned copies of
//! them.

pub(crate) mod contiguous;
pub(crate) mod decimation;
pub(crate) mod free_decay;
pub(crate) mod hold;
pub(crate) mod io_data;
pub(crate) mod markov_parameters;

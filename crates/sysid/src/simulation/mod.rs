//! Models run on a record: initial state, input matrices, continuation, and how well the outputs fit.

pub(crate) mod continuation;
pub(crate) mod fit;
pub(crate) mod initial_state;
pub(crate) mod input_matrices;
pub(crate) mod mirrored_poles;

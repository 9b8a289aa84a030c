//! What an assumed division of the mass adds to the intervals of models of several masses.
//! May use `assessment` and `likelihood` beside it, and what its own room may.

pub mod mixture;
pub(crate) mod transfer_posterior;

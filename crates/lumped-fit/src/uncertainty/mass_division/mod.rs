//! What an assumed division of the mass adds to the intervals of models of several masses.

pub mod mixture;
pub(crate) mod transfer_posterior;

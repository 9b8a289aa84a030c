//! The eigensystem realization algorithm: a model from Markov parameters.

pub(crate) mod era;
pub(crate) mod realization;

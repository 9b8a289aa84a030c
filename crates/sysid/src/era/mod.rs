//! The eigensystem realization algorithm, plain and on data correlations: a model from Markov parameters.

pub(crate) mod era;
pub(crate) mod era_dc;
pub(crate) mod realization;
pub(crate) mod shift_form;

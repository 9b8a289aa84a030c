//! How well fitted parameters are determined: covariance, intervals, profiles, bootstrap, propagation of uncertain
//! inputs.
//! May use `fit`, `closed_form`, `free`, `candidate` and `record`.

pub mod assessment;
pub mod block_bootstrap;
pub mod closed_form_propagation;
pub mod conditioned_propagation;
mod curve_posterior;
pub mod identifiability;
pub mod mass_division;
pub mod profile_likelihood;
pub mod propagation;
pub(crate) mod source_misfit;

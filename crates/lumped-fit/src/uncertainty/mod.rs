//! How well fitted parameters are determined: covariance, intervals, profiles, bootstrap, propagation of uncertain
//! inputs.

pub mod assessment;
pub mod block_bootstrap;
pub mod closed_form_propagation;
pub mod conditioned_propagation;
pub mod identifiability;
pub mod least_misfit;
pub mod likelihood;
pub mod mass_division;
pub mod propagation;

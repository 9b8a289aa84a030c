//! How well fitted parameters are determined: covariance, intervals, profiles, bootstrap, propagation of uncertain
//! inputs.

pub mod acceleration_likelihood;
pub mod assessment;
pub mod curve_posterior;
pub mod mass_division;
pub mod profile_likelihood;
pub mod propagation;
pub mod transfer_posterior;

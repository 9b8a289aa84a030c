//! Intervals by the likelihood: profiles, the accelerations in units of the noise, the posterior of curves with knots.

pub(crate) mod curve_posterior;
pub mod profile_likelihood;
pub(crate) mod source_misfit;

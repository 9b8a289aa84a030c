//! Chains of any number of masses: stated, fitted to waves, with covariance, dual, profiles, bootstrap and propagation.

pub mod assessment;
pub mod coordinates;
pub mod dual;
pub mod fit;

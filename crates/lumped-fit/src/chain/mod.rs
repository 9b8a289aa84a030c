//! Chains of any number of masses: stated, fitted to waves, with covariance, dual, profiles, bootstrap and
//! propagation.
//! May use `uncertainty`, `fit`, `free`, `candidate` and `record`.

pub mod assessment;
pub mod coordinates;
pub mod dual;
pub mod fit;

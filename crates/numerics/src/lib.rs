//! Numerics of all crates, free of files and of crashes, every function the same bits for the same input.
//!
//! - [`linalg`]: singular values, least squares, inner products, Fourier transforms of small dense problems;
//! - [`lti`]: linear time-invariant systems, their discretisation, poles and responses;
//! - [`estimation`]: bounded minimisers, statistics of residuals, reproducible random numbers.

pub mod estimation;
pub mod linalg;
pub mod lti;

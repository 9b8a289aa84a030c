//! Numerics of all crates, free of files and of crashes, every function the same bits for the same input.
//!
//! - [`linalg`]: singular values, least squares, inner products, Fourier transforms of small dense problems;
//! - [`lti`]: linear time-invariant systems, their discretisation, poles and responses;
//! - [`estimation`]: bounded minimisers, statistics of residuals, reproducible random numbers.

pub mod estimation {
    //! Estimation: minimise a cost within bounds, say how well the minimum is determined, draw random numbers.
    //!
    //! Nothing here knows what a model is: problems are traits that give residuals (and their derivatives where they
    //! have them) at a vector of unknowns, statistics take slices of residuals. A descent that did not converge says
    //! so: [`crate::estimation::minimise::StopReason`] is part of every result.

    pub mod minimise;
    pub mod random;
    pub mod statistics;
}
pub mod linalg;
pub mod lti;

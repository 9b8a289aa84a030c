//! Numerics of all crates, free of files and of crashes, every function the same bits for the same input.
//!
//! - [`linalg`]: singular values, least squares, inner products, Fourier transforms of small dense problems;
//! - [`lti`]: linear time-invariant systems, their discretisation, poles and responses;
//! - [`estimation`]: bounded minimisers, statistics of residuals, reproducible random numbers;
//! - [`thinning`]: lines through points with fewer of them.
//!
//! ```
//! use crumple_numerics::lti::TransferFunction;
//!
//! // 1/(s² + 4 s + 104) has the poles -2 ± 10i.
//! let poles = TransferFunction::new(&[1.0], &[1.0, 4.0, 104.0])?.poles()?;
//! assert!(poles.iter().all(|pole| (pole.re + 2.0).abs() < 1e-12 && (pole.im.abs() - 10.0).abs() < 1e-12));
//! # Ok::<(), crumple_numerics::lti::LtiError>(())
//! ```

pub mod estimation {
    //! Estimation: minimise a cost within bounds, say how well the minimum is determined, draw random numbers.
    //!
    //! Nothing here knows what a model is: problems are traits that give residuals (and their derivatives where they
    //! have them) at a vector of unknowns, statistics take slices of residuals. A descent that did not converge says
    //! so: [`crate::estimation::minimise::StopReason`] is part of every result.

    pub mod minimise;
    pub mod random;
    pub mod statistics;
    pub mod work;
}
pub mod linalg;
pub mod lti;
pub mod thinning;

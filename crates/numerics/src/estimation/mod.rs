//! Estimation: minimise a cost within bounds, say how well the minimum is determined, draw random numbers reproducibly.
//!
//! Nothing here knows what a model is: problems are traits that give residuals (and their derivatives where they have
//! them) at a vector of unknowns, statistics take slices of residuals. A descent that did not converge says so:
//! [`minimise::StopReason`] is part of every result.

pub mod minimise;
pub mod random;
pub mod statistics;

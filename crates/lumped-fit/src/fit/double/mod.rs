//! The double spring-mass-damper fitted to the displacement of its compartment, as pairs of duals.
//! May use `fit/halton_starts`, `free`, `candidate` and `record`.

pub mod multistart;
pub mod pair;
pub mod residuals;

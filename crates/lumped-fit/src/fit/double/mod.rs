//! The double spring-mass-damper fitted to the displacement of its compartment, as pairs of duals.
//! May use `fit/multistart`, `fit/descents`, `fit/halton_starts`, `free`, `candidate` and `record`.

pub mod pair;
pub mod residuals;

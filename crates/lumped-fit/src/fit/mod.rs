//! Models fitted to records by bounded least squares: searches on the motion itself, and the one fit as measured.

pub mod as_measured;
pub mod at_crush;
pub mod descents;
pub mod halton_starts;
pub mod multistart;
pub mod nonlinear;
pub mod options;
pub mod problem;
pub mod search;

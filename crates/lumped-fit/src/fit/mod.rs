//! Models fitted to records by bounded least squares: searches on the motion itself, and the one fit as measured.

pub mod as_measured;
pub mod nonlinear;
pub mod problem;
pub mod search;

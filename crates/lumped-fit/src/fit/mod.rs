//! Models fitted to records by bounded least squares: the double model, single masses, any model to any sensors.
//! May use `free`, `candidate` and `record`.

pub mod as_measured;
pub mod descents;
pub mod halton_starts;
pub mod nonlinear;
pub mod options;
pub mod problem;
pub mod search;

//! Models fitted to records by bounded least squares: the double model, single masses, any model to any sensors.
//! May use `free`, `candidate` and `record`.

pub mod closed_form_fit;
pub mod descents;
pub mod double;
pub mod elastoplastic_fit;
pub mod halton_starts;
pub mod maxwell_fit;
pub mod multistart;
pub mod nonlinear;
pub mod observed_problem;
pub mod options;
pub mod refine;
pub mod sensors;

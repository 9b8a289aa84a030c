//! Simulates candidate models and compares them with the test.
//!
//! Every response is exact (see `crumple-lumped`): what differs from the test is the model, not the integration.
//! Ranking the candidates belongs to the report.

mod excitation;
mod measures;
mod simulate;

pub use excitation::Excitation;
pub use measures::{fit_percent, max_abs_error, rmse};
pub use simulate::{Comparison, Measured, SimulateError, Simulation, Window, simulate, simulate_driven};

//! Simulates candidate models and compares them with the test.
//!
//! Every response is exact (see `crumple-lumped`): what differs from the test is the model, not the integration.
//! Ranking the candidates belongs to the report.

mod measures;
mod simulate;

pub use measures::max_abs_error;
pub use simulate::{Comparison, Measured, SimulateError, Simulation, Window, simulate};

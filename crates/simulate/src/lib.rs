//! Simulates candidate models and compares them with the test.
//!
//! Every response is exact (see `crumple-lumped`): what differs from the test is the model, not the integration.
//! Ranking the candidates belongs to the report.

mod comparison;
mod drive;
mod simulate;

pub use comparison::information::{Information, information, parameters_of};
pub use comparison::measures::max_abs_error;
pub use comparison::other_sensor::{OtherSensor, SensorFit, beside, beside_mass, is_on_engine};
pub use comparison::ratings::{Rating, iso_ratings, ratings};
pub use drive::excitation::Excitation;
pub use simulate::{
    Comparison, Measured, SimulateError, Simulation, Window, simulate, simulate_chain, simulate_driven,
};

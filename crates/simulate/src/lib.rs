//! Simulates candidate models and compares them with the test.
//!
//! Every response is exact (see `crumple-lumped`): what differs from the test is the model, not the integration.
//! Ranking the candidates belongs to the report.

mod excitation;
mod information;
mod measures;
mod other_sensor;
mod ratings;
mod simulate;

pub use excitation::Excitation;
pub use information::{Information, information, parameters_of};
pub use measures::max_abs_error;
pub use other_sensor::{OtherSensor, SensorFit, beside, beside_mass, is_on_engine};
pub use ratings::{Rating, iso_ratings, ratings};
pub use simulate::{
    Comparison, Measured, SimulateError, Simulation, Window, simulate, simulate_chain, simulate_driven,
};

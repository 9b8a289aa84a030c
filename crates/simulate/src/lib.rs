//! Simulates candidate models and compares them with the test.
//!
//! Every response is exact (see `crumple-lumped`): what differs from the test is the model, not the integration.
//! Ranking the candidates belongs to the report.
//!
//! rooms: stage | comparison drive

mod comparison;
mod drive;
mod error;
mod simulate;

pub use comparison::information::{Information, information, parameters_of};
pub use comparison::other_sensor::{OtherSensor, SensorFit, beside, beside_mass, is_on_engine};
pub use comparison::ratings::{Rating, iso_ratings, ratings};
pub use comparison::simulation::{Comparison, Measured, Simulation, Window};
pub use drive::excitation::Excitation;
pub use error::SimulateError;
pub use simulate::{simulate, simulate_chain, simulate_driven};

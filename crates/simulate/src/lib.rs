//! Simulates candidate models and compares them with the test.
//!
//! Every response is exact (see `crumple-lumped`): what differs from the test is the model, not the integration.
//! Ranking the candidates belongs to the report.
//!
//! Quantities are SI, with the axes of SAE J211-1 as in the test: displacement is crush, positive towards the barrier,
//! and a vehicle that is stopped has a negative acceleration. Time zero of a model is first contact, at displacement 0
//! and the impact speed; sample `k` of a response is at `k·dt` after it, `dt` the interval of the test. Masses are
//! counted from the barrier on, and the last is the compartment, where the accelerometer of the pulse sits.
//!
//! Model and test are compared from time zero to dynamic crush unless another end is stated: after rebound a linear
//! model of loading is no prediction. Each error is a difference model minus test. A comparison with a record that the
//! model was fitted to shows how well it was fitted; only another sensor or another test is a check.
//!
//! Definitions of the models: `docs/methods/lumped-models.md`; of the numbers: `docs/metrics.md`.

mod comparison;
mod error;
mod residual;
mod simulate;
mod stage;

pub use comparison::{
    Comparison, Measured, OtherSensor, Rating, SensorFit, Simulation, Window, beside, beside_mass, deceleration_peak,
    is_on_engine, ratings,
};
pub use error::SimulateError;
pub use residual::{Residual, residual};
pub use simulate::{Excitation, simulate, simulate_chain, simulate_driven};

/// The program.
pub const PROGRAM: crumple_stage::Program = crumple_stage::Program::of_stage::<stage::Simulate>();

//! Linear time-invariant systems: state space and transfer functions, the matrix exponential and logarithm, exact
//! discretisation and back, poles and modes, and the responses of discrete models.
//!
//! Everything here is small and dense (a crash model has two to twenty states), `f64`, sequential and free of files.
//! Time is in seconds, poles in 1/s and rad/s.

mod conversion;
pub mod eigenvalues;
mod error;
pub mod matrix_functions;
mod model;
mod responses;

pub use conversion::{
    Continuous, FirstOrderHold, InputHold, discretize_first_order_hold, discretize_zero_order_hold, to_continuous,
    to_transfer_function, undo_zero_order_hold,
};
pub use eigenvalues::{Complex, eigenvalues, eigenvectors, polynomial_roots};
pub use error::LtiError;
pub use matrix_functions::{matrix_exponential, matrix_logarithm};
pub use model::{Mode, StateSpace, TransferFunction};
pub use responses::{
    end_what_decayed, free_response, frequency_response, impulse_response, response, simulate, step_response,
};

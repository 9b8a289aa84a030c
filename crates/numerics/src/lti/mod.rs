//! Linear time-invariant systems: state space and transfer functions, the matrix exponential and logarithm, exact
//! discretisation and back, poles and modes, and the responses of discrete models.
//!
//! Everything here is small and dense (a crash model has two to twenty states), `f64`, sequential and free of files.
//! Time is in seconds, poles in 1/s and rad/s.

mod conversion;
mod error;
mod matrix;
mod model;
mod responses;

pub use conversion::continuous::{Continuous, InputHold, to_continuous};
pub use conversion::first_order_hold::{FirstOrderHold, discretize_first_order_hold};
pub use conversion::to_transfer_function::to_transfer_function;
pub use conversion::zero_order_hold::{discretize_zero_order_hold, undo_zero_order_hold};
pub use error::LtiError;
pub use matrix::complex::Complex;
pub use matrix::eigen::{eigenvalues, eigenvectors};
pub use matrix::exponential::matrix_exponential;
pub use matrix::logarithm::matrix_logarithm;
pub use matrix::roots::polynomial_roots;
pub use model::{Mode, StateSpace, TransferFunction};
pub use responses::frequency_response::frequency_response;
pub use responses::response::{free_response, impulse_response, response, step_response};
pub use responses::simulate::simulate;

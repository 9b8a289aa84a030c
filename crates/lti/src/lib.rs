//! Linear time-invariant systems: state space and transfer functions, the matrix exponential and logarithm, exact
//! discretisation and back, poles and modes, and the responses of discrete models.
//!
//! Everything here is small and dense (a crash model has two to twenty states), `f64`, sequential and free of files.
//! Time is in seconds, poles in 1/s and rad/s.

mod continuous;
mod eigen;
mod error;
mod exponential;
mod first_order_hold;
mod frequency_response;
mod from_transfer_function;
mod logarithm;
mod mode;
mod response;
mod roots;
mod simulate;
mod state_space;
mod to_transfer_function;
mod transfer_function;
mod tustin;
mod zero_order_hold;

pub use continuous::{Continuous, InputHold, to_continuous};
pub use eigen::{eigenvalues, eigenvectors, sort_poles};
pub use error::LtiError;
pub use exponential::matrix_exponential;
pub use first_order_hold::{FirstOrderHold, discretize_first_order_hold, undo_first_order_hold};
pub use frequency_response::frequency_response;
pub use from_transfer_function::to_state_space;
pub use logarithm::matrix_logarithm;
pub use mode::Mode;
pub use response::{free_response, impulse_response, response, step_response};
pub use roots::polynomial_roots;
pub use simulate::simulate;
pub use state_space::StateSpace;
pub use to_transfer_function::to_transfer_function;
pub use transfer_function::TransferFunction;
pub use tustin::{discretize_tustin, undo_tustin};
pub use zero_order_hold::{discretize_zero_order_hold, undo_zero_order_hold};

/// A complex number, as nalgebra uses it.
pub type Complex = nalgebra::Complex<f64>;

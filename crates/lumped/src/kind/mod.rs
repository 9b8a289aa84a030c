//! The families by name and what their parameters are.
//! May use nothing.

pub mod model_kind;

//! Remarks of a computation, each with a severity.

pub mod bearing;
pub mod note;

//! Remarks of a computation, each with a severity.
//! Uses no other room.

pub mod bearing;
pub mod note;

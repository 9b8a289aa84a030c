//! Lines and progress on stderr.
//! May use no other room.

pub mod layout;
pub mod progress;
pub mod say;

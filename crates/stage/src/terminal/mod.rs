//! Lines and progress on stderr.

pub mod layout;
pub mod progress;
pub mod say;

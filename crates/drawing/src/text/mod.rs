//! Numbers as people write them, and text made safe for HTML.
//! Uses no other room.

pub mod escape;
pub mod numbers;

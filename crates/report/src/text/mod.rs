//! Numbers and names as people write them, and text made safe for HTML.
//! Uses no other room.

pub mod escape;
pub mod language;
pub mod markdown;
pub mod numbers;
pub mod parameters;
pub mod phrases;

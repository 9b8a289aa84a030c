//! Numbers as people write them, and text made safe for HTML.

pub mod escape;
pub mod numbers;

//! Text made safe for HTML.

pub mod escape;

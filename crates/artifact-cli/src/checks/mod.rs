//! Checks that an intact artifact says what the format demands.
//! Uses show.

pub mod check;

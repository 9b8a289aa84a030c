//! Checks that an intact artifact says what the format demands.

pub mod check;

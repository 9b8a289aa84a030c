//! The channel frequency classes: coefficients, limits of the response, both passes over a record.

pub mod class;
pub mod coefficients;
pub mod corridor;
pub mod mode;
pub mod zero_phase;

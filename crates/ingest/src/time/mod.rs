//! The time axis: uniform grid, resampling, unit, time zero.

pub mod grid;
pub mod resampling;
pub mod time_unit;
pub mod time_zero;

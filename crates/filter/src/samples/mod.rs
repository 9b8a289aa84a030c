//! What is done to samples beside the filters: zero level, moving average, derivative, resampling, delay; which are
//! kept.

pub mod delay;
pub mod derivative;
pub mod kept;
pub mod moving_average;
pub mod resampling;
pub mod zero_level;

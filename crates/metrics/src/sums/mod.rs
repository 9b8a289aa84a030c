//! Cumulative sums and means over windows.

pub mod cumulative;
pub mod sliding_mean;

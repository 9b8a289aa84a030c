//! Cumulative sums and means over windows.
//! May use `metric`.

pub mod cumulative;
pub mod sliding_mean;

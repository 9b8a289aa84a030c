//! What the benchmark programs measure with.

pub mod stopwatch;

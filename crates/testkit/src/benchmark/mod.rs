//! What the benchmark programs measure with.
//! Uses no other room.

pub mod stopwatch;

//! The runs of a fleet: which there are, which are up to date, how they are started side by side, how each ended.

pub mod journal;
pub mod plan;
pub mod pool;
pub mod programs;
pub mod progress;
pub mod start;

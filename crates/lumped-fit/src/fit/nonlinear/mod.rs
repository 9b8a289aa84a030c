//! TODO room

pub mod fit;
pub mod momentum_starts;
pub mod problem;

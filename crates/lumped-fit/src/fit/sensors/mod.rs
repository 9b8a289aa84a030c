//! TODO room

pub mod fit;
pub mod problem;

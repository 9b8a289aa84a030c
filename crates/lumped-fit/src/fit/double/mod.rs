//! TODO room

pub mod multistart;
pub mod pair;
pub mod residuals;

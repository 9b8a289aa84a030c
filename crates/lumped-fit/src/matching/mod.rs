//! The double model from the poles of an identified model: every solution, and the standard deviations of each.

pub mod coefficient_matching;
pub mod coefficient_spread;

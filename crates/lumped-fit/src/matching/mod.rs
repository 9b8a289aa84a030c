//! The double model from the poles of an identified one: every solution, and its spread.
//! May use `candidate`.

pub mod coefficient_matching;
pub mod coefficient_spread;

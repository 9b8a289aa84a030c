//! Linear least squares: tall systems row block by row block, and with non-negative unknowns.

mod nonnegative_least_squares;
mod triangular_factor;

pub use nonnegative_least_squares::nonnegative_least_squares;
pub use triangular_factor::{CONDITION_LIMIT, Solution, TriangularFactor};

//! Triangular factors and solutions of regressions on shifted copies of signals.
//! May use error.

pub(crate) mod data_triangle;
pub(crate) mod lagged_regression;
pub(crate) mod shifted_products;

//! Triangular factors and solutions of regressions on shifted copies of signals.

pub(crate) mod data_triangle;
pub(crate) mod lagged_regression;
pub(crate) mod shifted_products;

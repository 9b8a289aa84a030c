//! How the rows of a table are written, and their numbers by columns.

pub mod layout;
pub mod numbers;

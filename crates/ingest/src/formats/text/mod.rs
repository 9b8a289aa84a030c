//! Lines, numbers and column names of text files.

pub mod column_names;
pub mod lines;
pub mod numbers;

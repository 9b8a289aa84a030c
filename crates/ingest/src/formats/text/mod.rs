//! Lines, numbers and column names of text files.
//! May be used by all readers of text.

pub mod column_names;
pub mod lines;
pub mod numbers;

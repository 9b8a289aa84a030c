//! The table of a chain of masses in a pipeline file, key by key.
//! May use `command_line`, for names that do not exist.

pub mod chain_total;
pub mod keys;
pub mod masses_table;

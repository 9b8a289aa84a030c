//! The table of a chain of masses in a pipeline file, key by key.

pub mod chain_total;
pub mod keys;
pub mod masses_table;

//! Flags and pipeline keys, the settings they come to, and the tables of chains.

pub mod assessment;
pub mod chain_table;
pub mod flags;
mod provenance;
pub mod settings;

//! Flags and pipeline keys, the settings they come to, and the tables of chains.
//! Uses no other room.

pub mod assessment;
pub mod chain_table;
pub mod flags;
mod provenance;
pub mod settings;

//! What the names and keys of records are called: metrics, quantities, states of channels, definitions.

pub mod definitions;
pub mod metrics;

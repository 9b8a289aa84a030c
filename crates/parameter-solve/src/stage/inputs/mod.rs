//! What the artifacts hold, as the library takes it: measurements, motions, identified models, exponential sums.

pub mod identified_models;
pub mod masses;
pub mod motions;
pub mod record;

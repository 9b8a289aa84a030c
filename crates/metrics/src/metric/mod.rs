//! What a metric is: value, unit, definition, window, interval; the catalogue of definitions; one grid for two signals.

pub mod definitions;
pub mod grid;
pub mod value;

//! Flags and keys of the pipeline file, and the settings they resolve to.

pub mod choices;
pub mod flags;
pub mod left_out;
pub mod orders;
pub mod paper;
pub mod settings;

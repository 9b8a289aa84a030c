//! Flags and keys of the pipeline file, and the settings they resolve to.

pub mod arx_structure;
pub mod evidence;
pub mod flags;
pub mod hankel;
pub mod input_output;
pub mod order;
pub mod paper;
pub mod settings;

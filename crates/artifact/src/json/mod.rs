//! Records as JSON text, known by the name of their schema alone, and patterns of topics.

pub mod registry;
pub mod topics;

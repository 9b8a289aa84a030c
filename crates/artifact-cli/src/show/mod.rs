//! Shows an artifact, as text for people or as NDJSON for programs.

pub mod json;
pub mod notes;
pub mod options;
pub mod text;

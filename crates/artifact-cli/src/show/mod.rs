//! Shows an artifact, as text for people or as NDJSON for programs.
//! Uses no other room.

pub mod json;
pub mod notes;
pub mod options;
pub mod text;

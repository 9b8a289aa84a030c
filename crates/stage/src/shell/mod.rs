//! Commands as a person types them for a shell: their words, and how they are started.

pub mod command;
pub mod words;

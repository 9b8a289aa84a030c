//! Commands as a person types them for a shell: their words, and how they are started.
//! May use no other room.

pub mod command;
pub mod words;

//! Reads an artifact and checks everything in it.
//! Uses layout and records.

pub mod chunk;
pub mod named_pipe;
pub mod reader;

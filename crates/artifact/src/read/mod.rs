//! Reads an artifact and checks everything in it.

pub mod chunk;
pub mod decompress;
pub mod named_pipe;
pub mod reader;

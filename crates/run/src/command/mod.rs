//! The command line: options, the stages with their programs, the pipeline file.
//! May use no other room.

pub mod options;
pub mod pipeline;
pub mod program;
pub mod stages;
pub mod words;

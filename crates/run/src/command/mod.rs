//! The command line: options, the stages with their programs, the pipeline file.

pub mod options;
pub mod pipeline;
pub mod program;
pub mod stages;
pub mod words;

//! The command line: options, the commands of the stages, the pipeline file, where a command's program is.

pub mod options;
pub mod pipeline;
pub mod program;
pub mod stages;

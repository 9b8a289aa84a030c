//! The life of a process: of a stage from its command line to its exit code, and of other programs.

pub mod no_result;
pub mod run;
pub mod tool;

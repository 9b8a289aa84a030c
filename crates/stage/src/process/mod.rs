//! The life of a process: of a stage from its command line to its exit code, and of other programs.
//! May use every other room.

pub mod no_result;
pub mod run;
pub mod tool;

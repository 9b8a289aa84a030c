//! The command line of the programs.

pub mod options;
pub mod sweep;

//! The command line of the programs.
//! May use no other room.

pub mod options;
pub mod sweep;

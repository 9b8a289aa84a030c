//! The chain of the stages and what they write; the name nearest to a mistyped one.
//! May use no other room.

pub mod folders;
pub mod nearest;
pub mod stages;

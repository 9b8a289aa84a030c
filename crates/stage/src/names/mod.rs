//! The chain of the stages and what they write; the name nearest to a mistyped one.

pub mod folders;
pub mod nearest;
pub mod stages;

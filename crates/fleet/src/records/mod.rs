//! The records of a fleet: found in folders, lists and patterns, known by the content of their files, named.

pub mod contents;
pub mod folder;
pub mod inputs;
pub mod names;
pub mod record;

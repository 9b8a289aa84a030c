//! The records of a fleet: found in folders, lists and patterns, known by the content of their files, named.
//! May use `command`, and `crumple-ingest` to recognise a file and to tell whether a record has changed.

pub mod contents;
pub mod folder;
pub mod inputs;
pub mod names;
pub mod record;

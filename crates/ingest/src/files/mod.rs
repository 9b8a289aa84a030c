//! The disk: a record's files, folders and zip archives into memory, the sidecar beside them.
//! May use formats and recording; the only room that uses std::fs.

pub mod digests;
pub mod open;
pub mod sidecar;
pub mod zip;

//! The disk: a record's files, folders and zip archives into memory, the sidecar beside them. The only room that uses
//! std::fs.

pub mod digests;
pub mod open;
pub mod sidecar;
pub mod zip;

//! The program: the stage ingest, the listing of channels, how refusals are worded.
//! May use everything of the library and crumple_stage; nobody uses it.

pub mod ingest;
pub mod list;

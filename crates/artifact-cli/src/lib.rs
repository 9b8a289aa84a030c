//! What people and programs in other languages do with an artifact: look into it, check it, take it apart into plain
//! files and put it together again.
//!
//! Everything here works on artifacts and texts in memory; files are the business of the binary.

mod check;
mod plain;
mod show;

pub use check::{Checked, check};
pub use plain::{
    PlainError, PlainProvenance, PlainRecord, PlainWave, assemble, f64_bytes, parse_lines, plain_records, plain_waves,
};
pub use show::{ShowOptions, Wanted, write_json, write_text};

//! What people and programs in other languages do with an artifact: look into it, check it, take it apart into plain
//! files and put it together again.
//!
//! Everything here works on artifacts and texts in memory; files are the business of the program.
//!
//! rooms: checks plain curves | show

mod checks;
mod curves;
mod error;
mod plain;
mod show;

pub use checks::{Checked, check};
pub use curves::{CurveFormat, text};
pub use curves::{StaticCurve, static_curves};
pub use error::{CurveError, PlainError};
pub use plain::{NearestSchema, assemble, parse_lines};
pub use plain::{PlainInput, PlainProvenance, PlainRecord, PlainWave};
pub use plain::{f64_bytes, plain_records, plain_waves};
pub use show::StageNotes;
pub use show::write_json;
pub use show::write_text;
pub use show::{ShowOptions, Wanted};

//! What people and programs in other languages do with an artifact: look into it, check it, take it apart into plain
//! files and put it together again.
//!
//! Everything here works on artifacts and texts in memory; files are the business of the program.

mod checks;
mod curves;
mod error;
mod plain;
mod show;

pub use checks::check::{Checked, check};
pub use curves::static_curve::{StaticCurve, static_curves};
pub use curves::tables::{CurveFormat, text};
pub use error::{CurveError, PlainError};
pub use plain::layout::{PlainInput, PlainProvenance, PlainRecord, PlainWave};
pub use plain::pack::{NearestSchema, assemble, parse_lines};
pub use plain::unpack::{f64_bytes, plain_records, plain_waves};
pub use show::json::write_json;
pub use show::notes::StageNotes;
pub use show::options::{ShowOptions, Wanted};
pub use show::text::write_text;

//! What people and programs in other languages do with an artifact: look into it, check it, take it apart into plain
//! files and put it together again; kits of stages in other languages.
//!
//! Everything here works on artifacts and texts in memory; files are the business of the program.

mod checks;
mod curves;
mod error;
mod explain;
mod new_stage;
mod plain;
mod show;
mod stage;

pub use checks::{Checked, check};
pub use curves::{CurveFormat, StaticCurve, static_curves, text};
pub use error::{CurveError, PlainError};
pub use plain::{
    NearestSchema, PlainInput, PlainProvenance, PlainRecord, PlainWave, SampleForm, assemble, parse_lines,
    plain_records, plain_waves,
};
pub use show::{ShowOptions, StageNotes, Wanted, write_json, write_text};
pub use stage::{CheckPassport, PROGRAM, PassportCheck, artifact};

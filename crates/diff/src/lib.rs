//! Compares results by what they mean: waveforms sample by sample, records value by value, within a tolerance.
//!
//! Two files with different bytes may hold the same result: another encoding, compression, processor or order of
//! topics. What counts as the same is a tolerance by topic and place ([`Tolerances`]); the normative text is
//! `docs/diff.md`. Everything here works on values in memory; reading files is the business of the program.

mod compare;
mod differences;
mod error;
mod print;
mod tolerances;

pub use compare::artifact::compare_artifacts;
pub use compare::json::compare_json;
pub use differences::{Comparison, Difference, FileReport, Side, TopicReport};
pub use error::DiffError;
pub use print::head::{head, tolerated_parameters};
pub use print::text::{TextOptions, write_text};
pub use tolerances::{Base, CompareSettings, Tolerance, ToleranceRule, Tolerances, parse_rules};

//! Compares results by what they mean: waveforms sample by sample, records value by value, within a tolerance.
//!
//! Two files with different bytes may hold the same result: another encoding, compression, processor or order of
//! topics. What counts as the same is a tolerance by topic and place ([`Tolerances`]); the normative text is
//! `docs/diff.md`. Everything here works on values in memory; reading files is the business of the binary.

mod artifact;
mod candidate;
mod error;
mod first;
mod head;
mod polynomial;
mod provenance;
mod report;
mod text;
mod tolerance;
mod tolerance_file;
mod unit;
mod value;
mod wave;
mod words;

pub use artifact::compare_artifacts;
pub use error::DiffError;
pub use head::{head, tolerated_parameters};
pub use report::{Difference, FileReport, Report, Side, TopicReport};
pub use text::{TextOptions, write_text};
pub use tolerance::{Base, Tolerance, Tolerances};
pub use tolerance_file::{Rule, parse_rules};
pub use value::compare_json;
pub use wave::compare_waves;

/// What counts as different.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Settings {
    /// Tolerance by topic and place.
    pub tolerances: Tolerances,
    /// Whether -0.0 and 0.0 differ.
    pub bits: bool,
    /// Whether another stage version, configuration or input is a difference by itself.
    pub provenance: bool,
}

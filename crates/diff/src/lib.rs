//! Compares results by what they mean: waveforms sample by sample, records value by value, within a tolerance.
//!
//! Two files with different bytes may hold the same result: another encoding, compression, processor or order of
//! topics. What counts as the same is a tolerance by topic and place ([`Tolerances`]); the normative text is
//! `docs/diff.md`. Everything here works on values in memory; reading files is the business of the program.

mod allowed;
mod artifact;
mod candidate;
mod differences;
mod error;
mod json;
mod print;
mod ranking;
mod texts;
mod tolerances;

pub use allowed::{SAME_SHARE, Tolerance};
pub use artifact::{compare_artifacts, open_candidates, remarks_by_code};
pub use crumple_artifact::ToleranceRule;
pub use differences::{Comparison, Difference, FileReport, NotCompared, Reason, Side, Step, TopicReport};
pub use error::DiffError;
pub use json::{Limit, compare_json, compare_with_limits};
pub use print::{TextOptions, conclusion, write_text};
pub use tolerances::{Base, CompareSettings, Tolerances, parse_rules, rules_of};

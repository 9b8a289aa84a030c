//! All texts of reports in each language, and numbers as each writes them.
//!
//! A [`Language`](language::Language) has its [`Phrases`](phrases::Phrases); identifiers, notes of the stages and units
//! are not translated.

pub mod language;
pub mod names;
pub mod phrases;

//! Results as records of the artifact and lines of the summary.

pub mod candidate;
pub mod matching;
pub mod uncertainty;

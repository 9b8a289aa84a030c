//! Results as records of the artifact and lines of the summary.
//! May use `assess`, `inputs` and `options`.

pub mod candidate;
pub mod matching;
pub mod uncertainty;

//! Names of what the joint stages write.

/// Motion of a test.
pub(crate) const INTEGRATED: &str = "3-integrate.mcap";
/// Joint candidates.
pub(crate) const SOLVED: &str = "5-parameter-solve.mcap";
/// Predictions.
pub(crate) const PREDICTED: &str = "7-predict.mcap";
/// All of it for scripts.
pub(crate) const SUMMARY: &str = "summary.json";
/// What a person looks at.
pub(crate) const REPORT: &str = "report.html";

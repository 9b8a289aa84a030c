//! Many runs on one page: a sortable table with a small pulse each, runs without a result by reason, figures of all.

pub mod document;
pub mod failures;
pub mod indexed_run;
pub mod pulse;
pub mod quantities;
pub mod run_summary;
mod table;

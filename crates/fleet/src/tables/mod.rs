//! Tables of a fleet: tests, candidates, metrics, predictions, read from the run folders.

pub mod candidates;
pub mod comma_separated;
pub mod metrics;
pub mod parquet_file;
pub mod predictions;
pub mod rows;
pub mod table;
pub mod tests_table;
pub mod write;

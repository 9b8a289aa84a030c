//! The result of a comparison: reports of runs, files and topics, and their differences.

pub mod report;

//! The result of a comparison: reports of runs, files and topics, and their differences.
//! Uses no other room.

pub mod report;

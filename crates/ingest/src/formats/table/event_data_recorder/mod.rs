//! Reports of event data recorders: several tables in one text, cells in two units.

pub mod report;
mod tables;

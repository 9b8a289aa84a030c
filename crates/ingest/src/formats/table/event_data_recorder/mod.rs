//! Reports of event data recorders: several tables in one text, cells in two units.
//! May use the files of the room above that read one table, not its `mod.rs`.

pub mod report;
mod tables;

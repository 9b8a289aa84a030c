//! The table of channels of a record.
//! May use files, formats and recording.

pub mod channel_table;

//! The table of channels of a record.

pub mod channel_table;

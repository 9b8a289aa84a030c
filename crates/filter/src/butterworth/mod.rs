//! Butterworth filters of any order: design into sections, run over a record.

pub mod design;
pub mod pass;
pub mod sections;

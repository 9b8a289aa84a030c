//! The run folder: its lock, who holds it, whose files are in it, what an earlier run left behind.

pub mod content;
pub mod foreign_files;
pub mod holder;
pub mod lock;
pub mod pipeline_of_run;
pub mod state;
pub mod sweep;

//! The run folder: its lock, who holds it, whose files are in it, what an earlier run left behind.

pub mod content;
pub mod holder;
pub mod lock;
pub mod ours;
pub mod pipeline_of_run;
pub mod state;
pub mod sweep;

//! The run folder: its lock, who holds it, what an earlier run left behind.
//! May use `command`.

pub mod holder;
pub mod lock;
pub mod sweep;

//! The run folder: its lock, who holds it, what its files hold, what an earlier run left behind.
//! May use `command`.

pub mod content;
pub mod holder;
pub mod lock;
pub mod sweep;

//! Random numbers that are the same for any number of threads.
//! Uses nothing of this crate.

mod uniform_at;

pub use uniform_at::uniform_at;

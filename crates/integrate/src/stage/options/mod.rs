//! Flags and pipeline keys, the settings they come to, the uncertain inputs among them.
//! May use the library alone.

pub mod flags;
pub mod settings;
pub mod uncertainty;

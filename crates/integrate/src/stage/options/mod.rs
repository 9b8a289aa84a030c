//! Flags and pipeline keys, the settings they come to, the uncertain inputs among them.

pub mod flags;
pub mod settings;
pub mod uncertainty;

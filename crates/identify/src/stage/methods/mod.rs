//! The identification methods: what a method is given, how it runs, what it hands to the records.
//! May use records, waves, options.
//!
//! rooms: discrete

pub mod discrete;
pub mod era;
pub mod exponentials;
pub mod tfest;

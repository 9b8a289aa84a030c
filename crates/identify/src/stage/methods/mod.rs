//! The identification methods: what a method is given, how it runs, what it hands to the records.

pub mod arx;
pub mod discrete;
pub mod era;
pub mod exponentials;
pub mod okid;
pub mod subspace;
pub mod tfest;

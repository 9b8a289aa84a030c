//! The identification methods: what a method is given, how it runs, what it hands to the records.

pub mod arx;
pub mod discrete;
pub mod era;
pub mod exponentials;
pub mod okid_fir;
pub mod subspace;
pub mod tfest;

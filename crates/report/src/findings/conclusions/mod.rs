//! What a run comes to: kind of record, concerns, status, sentences, key numbers, distinct curves, console, summary.

pub mod concerns;
pub mod conclusion;
pub mod distinct_curves;
mod identified;
pub mod key_numbers;
pub mod kind;
mod occupants;
pub mod overview;
pub mod own_remarks;
pub mod several_tests;
pub mod status;
pub mod summary;
pub mod uses;

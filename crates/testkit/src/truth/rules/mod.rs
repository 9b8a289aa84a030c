//! What each sentence claims: its numbers, and a check of it against the truth of the record.

mod impacts;
mod models;
mod notes;
mod page;
mod poles;
mod rule;
mod status;

pub use crate::truth::rules::rule::{Registry, Spot, Surface};
pub use status::answer;

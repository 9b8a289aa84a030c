//! What each sentence claims: its numbers, and a check of it against the truth of the record.

mod choice;
mod models;
mod notes;
mod page;
mod registry;
mod remarks;
mod rule;
mod status;
mod vehicle;

pub use registry::Registry;
pub use rule::{Spot, Surface};
pub use status::answer;

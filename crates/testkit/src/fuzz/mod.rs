//! Programs on files as attackers make them: mutated bytes, and artifacts that are sound as containers and lie inside.

mod campaign;
mod tampering;

pub use crate::fuzz::campaign::{Campaign, Ending, Tally, run_campaign};

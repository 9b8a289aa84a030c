//! Programs on files as attackers make them: mutated bytes, and artifacts that are sound as containers and lie inside.

mod campaign;
mod ending;
mod mutation;
mod tampering;

pub use campaign::{Campaign, run_campaign};
pub use ending::{Ending, Tally};

//! Programs on files as attackers make them: mutated bytes, and artifacts that are sound as containers and lie inside;
//! and on records as people might bring them.

mod campaign;
mod plausible;
mod simulations;
mod tampering;

pub use crate::fuzz::campaign::{Campaign, Ending, Tally, run_campaign};
pub use crate::fuzz::simulations::run_simulations;

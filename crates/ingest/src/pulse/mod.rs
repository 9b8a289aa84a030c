//! Which channel is the crash pulse: rank of its place, choice, doubts, polarity.

pub mod choice;
pub mod compartment;
pub mod place_rank;
pub mod polarity;
pub mod velocity;

//! Which candidate to use: evidence as measured, prior knowledge of vehicles, and the choice with its reasons.

pub mod choice;
pub mod compared_candidate;
pub mod evidence;
pub mod inadequacy;
pub mod lower_speeds;
pub mod prior;
pub mod rating;
pub mod time_zero;

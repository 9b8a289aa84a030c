//! Which candidate to use: evidence as measured, prior knowledge of vehicles, and the choice with its reasons.

pub mod choice;
pub mod compared;
pub mod evidence;
pub mod other_speeds;
pub mod rating;

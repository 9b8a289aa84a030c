//! Motions of any structure by Taylor series from event to event, with their derivatives.

pub mod changes;
pub mod exit;
pub mod instants;
pub mod step;
pub mod walk;
pub mod zeros;

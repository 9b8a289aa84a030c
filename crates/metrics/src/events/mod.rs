//! The instants of a crash: time zero, dynamic crush, rebound, end of the event, separation.

pub mod collision;
pub mod crash_events;
pub mod plausibility;
pub mod separation;
pub mod time_zero;
pub mod unstopped;

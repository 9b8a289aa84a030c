//! Uniformly sampled signals, and the zero level before the event.
//! Uses units.

pub mod pre_event;
pub mod signal;

//! Uniformly sampled signals, the zero level before the event, and the steps from an acceleration to its motion.

pub mod free_fall;
pub mod pre_event;
pub mod recording_steps;
pub mod signal;

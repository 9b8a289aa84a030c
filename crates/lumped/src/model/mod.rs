//! A model of any family: its parameters by name, and what its structure answers.

pub mod lumped_model;
pub mod parameters;
pub mod simulation;

//! A model of any family: its parameters by name, its response, forces and energies, its derivatives.
//! May use every other room but `matching`.

pub mod dynamics;
pub mod lumped_model;
pub mod parameters;
pub mod sensitivity;

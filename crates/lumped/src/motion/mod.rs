//! What moves a model and what it answers: start, drive, motion, forces, energies, events, derivatives.

pub mod collision;
pub mod drive;
pub mod dynamics;
pub mod mass_motion;
pub mod pulse;
pub mod sensitivity;
pub mod start;

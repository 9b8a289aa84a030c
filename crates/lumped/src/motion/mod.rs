//! What moves a model and what it answers: drive, motion, forces, energies, events, derivatives.
//! May use nothing.

pub mod drive;
pub mod dynamics;
pub mod mass_motion;
pub mod sensitivity;

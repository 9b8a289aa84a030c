//! What a model is moved by and what it answers: drive, motion, forces, energies, events.
//! May use `kind`.

pub mod mass_motion;

//! What a structure answers: motions, derivatives, forces, energies, events; exactly or by series.

pub mod collisions;
pub mod element_paths;
pub mod events;
pub mod forces_and_energies;
pub mod front_to_front;
pub mod motions;
pub mod occupants;
pub mod partners;

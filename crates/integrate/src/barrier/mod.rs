//! Force on the barrier, from load cells and from the mass.

pub mod cell_sum;
pub mod inertia_force;

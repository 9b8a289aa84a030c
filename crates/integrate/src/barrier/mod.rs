//! Force on the barrier, from load cells and from the mass.
//! May use nothing.

pub mod cell_sum;
pub mod inertia_force;

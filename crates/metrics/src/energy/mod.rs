//! Force over crush, work, stiffness and crush energy.
//! May use `events` and `metric`.

pub mod average_stiffness;
pub mod crush_energy;
pub mod force_deflection;
pub mod work;

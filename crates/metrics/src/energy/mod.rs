//! Work of the pulse, average stiffness, crush energy.

pub mod average_stiffness;
pub mod crush_energy;
pub mod damage_profile;
pub mod wall_stiffness;
pub mod work;

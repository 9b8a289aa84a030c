//! Numbers beside the motion: occupants, roadside hardware, the stiffness of CRASH3, load cells of the barrier, event
//! data recorders.

pub mod crush_stiffness;
pub mod load_cells;
pub mod occupants_and_roadside;
pub mod recorder;
pub mod sensor_sites;

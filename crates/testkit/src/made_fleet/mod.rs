//! Records of a made fleet: cars whose stiffness and damping depend on mass and model year in a known way.

mod car;
mod record;

pub use car::{DAMPING_N_S_PER_M_PER_KG, FleetCar, MIDDLE_YEAR, STIFFNESS_N_PER_M_PER_KG, STIFFNESS_PER_YEAR};
pub use record::write_fleet;

//! Criteria of occupants: HIC, 3 ms clips, resultants, ride-down.

pub mod clip;
pub mod hic;
pub mod resultant;
pub mod ride_down;

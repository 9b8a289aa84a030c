//! Force-deflection curves and masses read off measured motions: a bounded linear least squares problem.

pub mod extract;
pub mod problem;

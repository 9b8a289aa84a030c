//! Force-deflection curves and masses read off measured motions: a bounded linear least squares problem.

pub mod extract;
pub mod joint_rate;
pub mod loading_history;
pub mod problem;

//! The table of solvers, the functions of its rows, and the call that runs all that settings ask for.

pub mod closed_forms;
pub mod crush_curves;
pub mod explanations;
pub mod extent;
pub mod fitting;
pub mod nearly_rigid;
pub mod sensors;
pub mod settings;
pub mod shared_mass;
pub mod single_mass;
pub mod solve;
pub mod table;
pub mod task;

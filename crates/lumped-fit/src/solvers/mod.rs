//! The table of solvers, the functions of its rows, and the call that runs all that settings ask for.

pub mod closed_forms;
pub mod crush_curves;
pub mod fitting;
pub mod load_paths;
pub mod sensors;
pub mod single_mass;
pub mod table;

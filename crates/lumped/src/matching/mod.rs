//! Springs and dampers of the double model from poles or a state space: every solution, in double length.

pub mod coefficient_matching;
pub mod cubic;
pub mod double_length;
pub mod physical_coordinates;
pub(crate) mod scaled_equations;

//! Which numbers of a model are free, as coordinates of size one with bounds, and how the mass divides.
//! May use `record`.

pub mod free_model;
pub mod free_numbers;
pub mod free_parameter;
pub mod mass_split;
pub mod model_coordinates;
pub mod parameterisation;
pub mod search_bounds;

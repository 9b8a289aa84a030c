//! Which numbers of a model are free, as coordinates of size one with bounds, and how the mass divides.

pub mod coordinates;
pub mod free_parameter;
pub mod mass_split;
pub mod parametric;
pub mod search_bounds;
pub mod search_coordinates;

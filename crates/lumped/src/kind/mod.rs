//! The families by name and what their parameters are: mass, stiffness, damping, the place of a knot.

pub mod model_kind;
pub mod parameter;
pub mod parse;

//! The elements: springs and dampers with any number of knots, both in series, a spring that unloads stiffer.
//! May use `structure/form` and `structure/law`.

pub mod damper;
pub mod piecewise_linear;
pub mod plastic_spring;
pub mod series_spring_damper;
pub mod spring;

//! One file a family of models: what it is made of, its closed form or its equations.
//! May use `secant`, `exact`, `motion` and `kind`.

pub mod chain;
pub mod double_spring_mass_damper;
pub mod elastoplastic;
pub mod kelvin;
pub mod maxwell;
pub mod nonlinear;

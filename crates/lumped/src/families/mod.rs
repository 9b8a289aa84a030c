//! One file a family of models: what it is made of, its closed form where it has one, the names of its parameters.

pub mod chain;
pub mod chain_parameters;
pub mod double_spring_mass_damper;
pub mod elastoplastic;
pub mod force_deflection;
pub mod kelvin;
pub mod load_paths;
pub mod maxwell;
pub mod nonlinear;
pub mod values;

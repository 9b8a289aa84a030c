//! Kelvin, elastoplastic and Maxwell model from crash events or exponents, by formula.

pub mod elastoplastic;
pub mod kelvin;
pub mod maxwell;

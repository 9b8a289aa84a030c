//! Masses in a row: linear chains, chains with knots, and the names of their parameters.
//! May use `secant`, `exact`, `motion` and `kind`.

pub mod linear;
pub mod parameters;
pub mod secant;

//! Motions with secant coefficients that are linear between knots: Taylor series from knot to knot.
//! May use `exact`, `motion` and `kind`.

pub mod chain;
pub mod curve;
pub mod piecewise_linear;
pub mod sensitivity;
pub mod single_mass;
pub mod step;

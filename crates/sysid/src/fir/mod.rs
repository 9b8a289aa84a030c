//! Impulse responses by regularised least squares.

pub(crate) mod fir;
pub(crate) mod kernel;

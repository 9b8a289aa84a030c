//! Impulse responses by regularised least squares.
//! May use regression, data, error.

pub(crate) mod fir;
pub(crate) mod kernel;

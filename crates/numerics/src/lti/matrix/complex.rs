//! Complex numbers.

/// A complex number, as nalgebra uses it.
pub type Complex = nalgebra::Complex<f64>;

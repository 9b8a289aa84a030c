//! Discrete Fourier transforms of real vectors.

mod real_transform;

pub use real_transform::{RealTransform, real_transform};

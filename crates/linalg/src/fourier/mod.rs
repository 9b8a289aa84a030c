//! Discrete Fourier transforms of real vectors.
//! Uses nothing of this crate.

mod real_transform;

pub use real_transform::{RealTransform, real_transform};

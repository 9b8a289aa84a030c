//! Linear algebra of small dense matrices, beside what nalgebra has: singular values to full relative accuracy, least
//! squares without normal equations, inner products in a fixed order; and the Fourier transforms of all crates.
//!
//! Every function gives the same bits for the same input: sums run in an order that is written down, and no routine
//! picks another one by the processor, but the Fourier transform. Matrices are nalgebra's `DMatrix<f64>`, column-major;
//! vectors are slices.

mod fourier;
mod least_squares;
mod product;
mod svd;

pub use fourier::{RealTransform, real_transform};
pub use least_squares::{CONDITION_LIMIT, Solution, TriangularFactor, nonnegative_least_squares};
pub use product::dot;
pub use realfft::num_complex::Complex64;
pub use realfft::{ComplexToReal, RealToComplex};
pub use svd::{SmallSvd, jacobi_svd, numerical_rank, pseudo_inverse_times};

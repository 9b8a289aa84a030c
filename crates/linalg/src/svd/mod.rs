//! Singular values of small matrices, and what is made of them: numerical rank, pseudo-inverse.

mod jacobi_svd;
mod pseudo_inverse;

pub use jacobi_svd::{SmallSvd, jacobi_svd};
pub use pseudo_inverse::{numerical_rank, pseudo_inverse_times};

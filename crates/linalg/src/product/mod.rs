//! Products of vectors in a fixed order of summation.
//! Uses nothing of this crate.

mod inner_product;

pub use inner_product::dot;

//! Products of vectors in a fixed order of summation.

mod inner_product;

pub use inner_product::dot;

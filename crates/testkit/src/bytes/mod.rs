//! Digests of everything the programs write over many command lines: the cases, their run, the comparison of two lists.

pub mod cases;
pub mod flags;
mod run;

pub use crate::bytes::run::{BytesError, Difference, compare, write_digests};

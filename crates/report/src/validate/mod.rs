//! A simulation against its test: which is stiffer, where, by which force, and what forbids trust.

pub mod checks;
pub mod figures;
pub mod ratings;
pub mod requirements;
pub mod segments;
pub mod tables;
pub mod validation;
pub mod verdict;

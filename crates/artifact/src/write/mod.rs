//! Builds an artifact and writes it in one piece.

pub mod atomic;
pub mod builder;
pub mod output_kind;

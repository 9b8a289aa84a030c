//! Builds an artifact and writes it in one piece.
//! Uses layout and records.

pub mod atomic;
pub mod builder;
pub mod output_kind;

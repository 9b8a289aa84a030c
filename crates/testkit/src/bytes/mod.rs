//! Digests of everything the programs write over many command lines: the cases, their run, the comparison of two lists.

mod case;
mod compare;
mod digest;
mod every_case;
mod made_records;
mod method_flags;
mod run;
mod stage_flags;

pub use compare::{Difference, compare};
pub use run::{BytesError, write_digests};

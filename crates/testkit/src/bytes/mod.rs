//! Digests of everything the programs write over many command lines, for changes that must not change a byte: cases, their run, comparison.
//! May use the fixtures' models and the artifact reader; no test uses it but its own.

mod case;
mod compare;
mod digest;
mod every_case;
mod method_flags;
mod records;
mod run;
mod stage_flags;

pub use case::{Case, Step};
pub use compare::{Difference, compare};
pub use digest::{Digests, digests_of_file, masked};
pub use every_case::{Phases, phases};
pub use run::{BytesError, write_digests};

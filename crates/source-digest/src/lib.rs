//! Digest of the sources of a program, for build scripts: what made an artifact is part of its provenance.

mod source_digest;

pub use source_digest::{source_digest, state};

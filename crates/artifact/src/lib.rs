//! What goes between stages: typed records and waveforms in one MCAP file.
//!
//! The normative text is `docs/format.md`. In short: small records are JSON, waveforms are blocks of 65,536 samples in
//! bincode; each channel declares its encoding and the reader takes either for any type; every CRC is written and
//! checked; provenance and a content digest travel with the data; the bytes depend on data and configuration alone.

mod atomic;
mod builder;
mod chunk;
mod codec;
mod digest;
mod error;
mod finite;
mod provenance;
mod reader;
pub mod records;
mod registry;
mod schema;
mod time_origin;
mod wave;

pub use atomic::{remove_in_order, replace_atomically, write_atomically};
pub use builder::{ArtifactBuilder, Compression};
pub use codec::Codec;
pub use digest::{ContentDigest, blake3_text};
pub use error::{ConversionError, ReadError, WriteError};
pub use provenance::{FORMAT_VERSION, InputDigest, Provenance};
pub use reader::{Artifact, RawRecord};
pub use records::Record;
pub use registry::{JsonForm, put_json, topic_matches};
pub use schema::viewer_safe_schema;
pub use wave::{BLOCK_SAMPLES, Wave};

/// Names the container's writer in the MCAP header; fixed, so that it never changes the bytes.
pub const LIBRARY: &str = "crumple artifact/1";

/// Whether two schema names are of one type, whatever their versions.
pub fn same_type(a: &str, b: &str) -> bool {
    reader::split_version(a).0 == reader::split_version(b).0
}

/// Topic prefix of waveforms.
pub const WAVE_PREFIX: &str = "/wave/";

//! What goes between stages: typed records and waveforms in one MCAP file.
//!
//! The normative text is `docs/format.md`. In short: small records are JSON, waveforms are blocks of 65,536 samples in
//! bincode; each channel declares its encoding and the reader takes either for any type; every CRC is written and
//! checked; provenance and a content digest travel with the data; the bytes depend on data and configuration alone.

mod error;
mod finite;
mod json;
mod layout;
mod limits;
mod read;
pub mod records;
mod write;

pub use error::{ConversionError, ReadError, WriteError};
#[cfg(feature = "schemas")]
pub use json::schema_of_type;
pub use json::topic_matches;
pub use json::{JsonForm, put_json, schema_json};
pub use layout::codec::Codec;
pub use layout::digest::{ContentDigest, blake3_text};
pub use layout::names::{WAVE_PREFIX, same_type};
pub use layout::provenance::{InputDigest, Provenance};
pub use layout::record::{Record, SCHEMAS};
pub use layout::wave::Wave;
pub use limits::{TOLERANCE_HINT, TOPICS, ToleranceRule};
pub use read::decompress::add_decompressors;
pub use read::named_pipe::refuse_named_pipe;
pub use read::reader::{Artifact, RawRecord};
pub use write::atomic::{readable, remove_in_order, replace_atomically, write_atomically};
pub use write::builder::{ArtifactBuilder, Compression};
pub use write::output_kind::OutputKind;

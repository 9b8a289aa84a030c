//! How an artifact is laid out: encodings, schemas, digest, provenance, times, blocks of waveforms.

pub mod codec;
pub mod digest;
pub mod json_text;
pub mod names;
pub mod provenance;
pub mod record;
#[cfg(feature = "schemas")]
pub mod schema;
pub mod time_origin;
pub mod wave;

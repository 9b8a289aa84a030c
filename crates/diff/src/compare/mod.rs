//! Compares artifacts, records, waveforms and provenance.

pub mod artifact;
pub mod json;
pub mod polynomial;
pub mod provenance;
pub mod wave;
pub mod words;

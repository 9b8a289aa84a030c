//! Compares artifacts, records, waveforms and provenance.
//! Uses tolerances and differences.

pub mod artifact;
pub mod json;
pub mod polynomial;
pub mod provenance;
pub mod wave;
pub mod words;

//! How an artifact lies in plain files: lines of records and waveforms, provenance.

use crumple_artifact::{InputDigest, Provenance};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A line of `records.ndjson`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlainRecord {
    /// Topic, e.g. `/events`.
    pub topic: String,
    /// Schema name, e.g. `crumple.Events.v1`.
    pub schema: String,
    /// The record.
    pub data: Value,
}

/// A line of `waves.ndjson`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlainWave {
    /// Channel id; the topic is `/wave/<id>`.
    pub id: String,
    /// Quantity, e.g. `acceleration`; the samples are in its SI unit.
    pub quantity: String,
    /// Time of the first sample, s.
    pub t0_s: f64,
    /// Sampling interval, s.
    pub dt_s: f64,
    /// Number of samples.
    pub samples: u64,
    /// File with the samples, 8 bytes each, little-endian IEEE 754; relative to the folder.
    pub file: String,
}

/// `provenance.json`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PlainProvenance {
    /// Name of the stage, e.g. `identify`.
    pub stage: String,
    /// Its version.
    pub stage_version: String,
    /// Its resolved configuration.
    pub config: Value,
    /// What it was made from.
    pub inputs: Vec<PlainInput>,
}

/// An input, in `provenance.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlainInput {
    /// Stage that wrote it, or format of a raw file.
    pub kind: String,
    /// Digest of its content.
    pub digest: String,
}

impl From<&Provenance> for PlainProvenance {
    fn from(provenance: &Provenance) -> Self {
        let input = |i: &InputDigest| PlainInput { kind: i.kind.clone(), digest: i.digest.clone() };
        Self {
            stage: provenance.stage.clone(),
            stage_version: provenance.stage_version.clone(),
            config: serde_json::from_str(&provenance.config_json)
                .unwrap_or_else(|_| provenance.config_json.clone().into()),
            inputs: provenance.inputs.iter().map(input).collect(),
        }
    }
}

impl From<PlainProvenance> for Provenance {
    fn from(plain: PlainProvenance) -> Self {
        let config = match plain.config {
            Value::Null => "{}".to_owned(),
            Value::String(text) => text,
            // Maps are sorted by key, so this is the canonical form.
            other => other.to_string(),
        };
        let inputs = plain.inputs.into_iter().map(|i| InputDigest { kind: i.kind, digest: i.digest }).collect();
        Self::new(&plain.stage, &plain.stage_version, config, inputs)
    }
}

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
    /// Digest of the sources of the program that made it.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub build: String,
    /// What put it together, where that was not the stage.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub made_by: String,
    /// Digest of the content that all this is said of; the artifact packed of other content is not the stage's.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub content: String,
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

impl PlainProvenance {
    /// What an artifact of the content `digest` says of itself.
    pub fn of_content(provenance: &Provenance, digest: &str) -> Self {
        let input = |i: &InputDigest| PlainInput { kind: i.kind.clone(), digest: i.digest.clone() };
        Self {
            stage: provenance.stage.clone(),
            stage_version: provenance.stage_version.clone(),
            config: serde_json::from_str(&provenance.config_json)
                .unwrap_or_else(|_| provenance.config_json.clone().into()),
            inputs: provenance.inputs.iter().map(input).collect(),
            build: provenance.build.clone(),
            made_by: provenance.made_by.clone(),
            content: digest.to_owned(),
        }
    }

    /// What is said of an artifact packed of content `digest`: all of it where that is the content it was said of, else
    /// that it was packed.
    pub fn of_packed(self, digest: &str) -> Provenance {
        let is_unchanged = self.content == digest;
        let provenance = Provenance::from(self);
        if is_unchanged { provenance } else { provenance.made_by(PACK) }
    }
}

/// What made an artifact that was put together of plain files.
const PACK: &str = "crumple-artifact pack";

impl From<PlainProvenance> for Provenance {
    fn from(plain: PlainProvenance) -> Self {
        let (build, made_by) = (plain.build, plain.made_by);
        let config = match plain.config {
            Value::Null => "{}".to_owned(),
            Value::String(text) => text,
            // Maps are sorted by key, so this is the canonical form.
            other => other.to_string(),
        };
        let inputs = plain.inputs.into_iter().map(|i| InputDigest { kind: i.kind, digest: i.digest }).collect();
        Self { made_by, ..Self::new(&plain.stage, &plain.stage_version, config, inputs).with_build(&build) }
    }
}

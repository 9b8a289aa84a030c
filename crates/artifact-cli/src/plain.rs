//! An artifact as plain text and numbers, and back, so that any language can be a stage.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

use crumple_artifact::records::{TestV1, WaveBlockV1};
use crumple_artifact::{
    Artifact, ArtifactBuilder, Compression, InputDigest, JsonForm, Provenance, ReadError, Record, SCHEMAS, WAVE_PREFIX,
    Wave, WriteError, put_json,
};
use crumple_signal::{QuantityKind, Sampled};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::PlainError;
use crate::show::{json_of, ndjson_line};

// How an artifact lies in plain files: lines of records and waveforms, provenance.

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
    /// File with the samples, relative to the folder; its ending tells their form.
    pub file: String,
}

/// How samples stand in the file of a waveform.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleForm {
    /// 8 bytes each, little-endian IEEE 754.
    Bytes,
    /// A number a line, in `*.txt`: the shortest text that reads back to the same number.
    Text,
}

impl SampleForm {
    /// The form in a file of this name.
    pub fn of_file(name: &str) -> Self {
        if Path::new(name).extension().is_some_and(|ending| ending == "txt") { Self::Text } else { Self::Bytes }
    }

    fn ending(self) -> &'static str {
        match self {
            Self::Bytes => "f64",
            Self::Text => "txt",
        }
    }

    /// The content of a wave's file.
    pub fn content(self, wave: &Wave) -> Vec<u8> {
        let samples = wave.sampled.samples().iter();
        match self {
            Self::Bytes => samples.flat_map(|sample| sample.to_le_bytes()).collect(),
            Self::Text => samples.map(|sample| format!("{sample:?}\n")).collect::<String>().into_bytes(),
        }
    }
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

// Puts an artifact together from plain text and numbers.

/// The schema that a mistyped name may mean.
pub type NearestSchema<'a> = &'a dyn Fn(&str) -> Option<&'static str>;

impl PlainWave {
    /// Puts the description and the content of its file together.
    pub fn with_bytes(&self, bytes: &[u8]) -> Result<Wave, PlainError> {
        let bad = |problem: String| PlainError::Wave { id: self.id.clone(), problem };
        let samples = match SampleForm::of_file(&self.file) {
            SampleForm::Text => self.numbers_in(bytes).map_err(bad)?,
            SampleForm::Bytes if Some(bytes.len() as u64) != self.samples.checked_mul(8) => {
                let problem = format!("{} has {} bytes, {} samples have 8 each", self.file, bytes.len(), self.samples);
                return Err(bad(problem));
            }
            SampleForm::Bytes => {
                bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap_or_default())).collect()
            }
        };
        let quantity: QuantityKind = self.quantity.parse().map_err(|problem: String| {
            let all: Vec<&str> = QuantityKind::ALL.iter().map(|kind| kind.name()).collect();
            bad(format!("{problem}, expected one of {}", all.join(", ")))
        })?;
        let sampled = Sampled::new(self.t0_s, self.dt_s, samples).map_err(|error| bad(error.to_string()))?;
        Ok(Wave { quantity, sampled })
    }

    /// The samples of a file with a number a line. Errors: a line that is no number, too few or too many lines.
    fn numbers_in(&self, bytes: &[u8]) -> Result<Vec<f64>, String> {
        let text = std::str::from_utf8(bytes).map_err(|error| format!("{}: {error}", self.file))?;
        let mut numbers = Vec::new();
        for (k, line) in text.lines().enumerate() {
            let number = line.trim().parse::<f64>();
            numbers.push(number.map_err(|error| format!("{}, line {}: {line:?}: {error}", self.file, k + 1))?);
        }
        if numbers.len() as u64 != self.samples {
            return Err(format!("{} has {} lines, {} samples have one each", self.file, numbers.len(), self.samples));
        }
        Ok(numbers)
    }
}

/// Parses NDJSON; empty lines are skipped. `file` is what messages call it.
pub fn parse_lines<T: DeserializeOwned>(file: &str, text: &str) -> Result<Vec<T>, PlainError> {
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    lines
        .map(|(k, line)| {
            serde_json::from_str(line).map_err(|error| PlainError::Line {
                file: file.to_owned(),
                line: k + 1,
                // To serde_json every line is the first.
                problem: error.to_string().replace(" at line 1 column ", " at column "),
            })
        })
        .collect()
}

/// Puts records and waveforms together.
///
/// A record of type WaveBlock under `/wave/<id>` is taken as a waveform of one block; what it measures is taken from
/// the last part of its id (`93/velocity`) or from the test's channel list. `nearest` completes the message on an
/// unknown schema.
pub fn assemble(
    records: Vec<PlainRecord>,
    waves: Vec<(String, Wave)>,
    nearest: NearestSchema<'_>,
) -> Result<ArtifactBuilder, PlainError> {
    let (typed, records): (Vec<_>, Vec<_>) = records
        .into_iter()
        .partition(|record| record.schema == WaveBlockV1::SCHEMA && record.topic.starts_with(WAVE_PREFIX));
    let typed = typed_waves(typed, records.iter().find(|record| record.schema == TestV1::SCHEMA), nearest)?;
    let mut builder = ArtifactBuilder::new();
    for record in records {
        put(&mut builder, record, nearest)?;
    }
    for (id, wave) in waves.into_iter().chain(typed) {
        builder.wave(&id, wave.quantity, wave.sampled)?;
    }
    Ok(builder)
}

fn put(builder: &mut ArtifactBuilder, record: PlainRecord, nearest: NearestSchema<'_>) -> Result<(), WriteError> {
    if !SCHEMAS.contains(&record.schema.as_str())
        && let Some(known) = nearest(&record.schema)
    {
        let problem = format!("schema {:?} is unknown, did you mean {known:?}?", record.schema);
        return Err(WriteError::Encode { topic: record.topic, problem });
    }
    put_json(builder, &record.topic, &record.schema, record.data)
}

/// The reader takes JSON blocks for waveforms, so it is asked what they are.
fn typed_waves(
    typed: Vec<PlainRecord>,
    test: Option<&PlainRecord>,
    nearest: NearestSchema<'_>,
) -> Result<BTreeMap<String, Wave>, PlainError> {
    if typed.is_empty() {
        return Ok(BTreeMap::new());
    }
    let mut builder = ArtifactBuilder::new();
    for record in test.cloned().into_iter().chain(typed) {
        put(&mut builder, record, nearest)?;
    }
    let mut bytes = Cursor::new(Vec::new());
    builder
        .write_to(&mut bytes, &PlainProvenance::default().into(), Compression::None)
        .map_err(|error| PlainError::Wave { id: "*".into(), problem: error.to_string() })?;
    Ok(Artifact::read(Path::new("the records"), bytes.get_ref().as_slice())?.waves().clone())
}

// Takes an artifact apart into plain text and numbers.

/// The text of `records.ndjson`.
///
/// Errors: a record that does not decode, or of another project in an encoding that is not JSON.
pub fn plain_records(artifact: &Artifact) -> Result<String, ReadError> {
    let mut text = String::new();
    for raw in artifact.records() {
        let data = json_of(artifact, raw, JsonForm::Line)?.ok_or_else(|| ReadError::Message {
            path: artifact.path().to_owned(),
            topic: raw.topic.clone(),
            problem: format!("encoding {:?} of {:?} cannot be written as JSON", raw.encoding, raw.schema),
        })?;
        text += &ndjson_line(&raw.topic, &raw.schema, &data);
        text.push('\n');
    }
    Ok(text)
}

/// The lines of `waves.ndjson`, in the order of the artifact's waveforms, for samples in this form.
pub fn plain_waves(artifact: &Artifact, form: SampleForm) -> Vec<PlainWave> {
    let file = |k: usize, id: &str| {
        let safe = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
        let name: String = id.chars().map(safe).take(60).collect();
        format!("waves/{:03}-{name}.{}", k + 1, form.ending())
    };
    artifact
        .waves()
        .iter()
        .enumerate()
        .map(|(k, (id, wave))| PlainWave {
            id: id.clone(),
            quantity: wave.quantity.name().to_owned(),
            t0_s: wave.sampled.t0_s(),
            dt_s: wave.sampled.dt_s(),
            samples: wave.sampled.len() as u64,
            file: file(k, id),
        })
        .collect()
}

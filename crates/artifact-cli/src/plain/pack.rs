//! Puts an artifact together from plain text and numbers.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

use crumple_artifact::records::{TestV1, WaveBlockV1};
use crumple_artifact::{
    Artifact, ArtifactBuilder, Compression, Record, SCHEMAS, WAVE_PREFIX, Wave, WriteError, put_json,
};
use crumple_signal::{QuantityKind, Sampled};
use serde::de::DeserializeOwned;

use super::layout::{PlainProvenance, PlainRecord, PlainWave};
use crate::PlainError;

/// The schema that a mistyped name may mean.
pub type NearestSchema<'a> = &'a dyn Fn(&str) -> Option<&'static str>;

impl PlainWave {
    /// Puts the description and the content of its file together.
    pub fn with_bytes(&self, bytes: &[u8]) -> Result<Wave, PlainError> {
        let bad = |problem: String| PlainError::Wave { id: self.id.clone(), problem };
        if Some(bytes.len() as u64) != self.samples.checked_mul(8) {
            let problem = format!("{} has {} bytes, {} samples have 8 each", self.file, bytes.len(), self.samples);
            return Err(bad(problem));
        }
        let quantity: QuantityKind = self.quantity.parse().map_err(|problem: String| {
            let all: Vec<&str> = QuantityKind::ALL.iter().map(|kind| kind.name()).collect();
            bad(format!("{problem}, expected one of {}", all.join(", ")))
        })?;
        let samples = bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap_or_default())).collect();
        let sampled = Sampled::new(self.t0_s, self.dt_s, samples).map_err(|error| bad(error.to_string()))?;
        Ok(Wave { quantity, sampled })
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

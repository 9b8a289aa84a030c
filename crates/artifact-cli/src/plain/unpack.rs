//! Takes an artifact apart into plain text and numbers.

use crumple_artifact::{Artifact, JsonForm, ReadError, Wave};

use super::layout::PlainWave;
use crate::show::json::{json_of, ndjson_line};

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

/// The lines of `waves.ndjson`, in the order of the artifact's waveforms.
pub fn plain_waves(artifact: &Artifact) -> Vec<PlainWave> {
    let file = |k: usize, id: &str| {
        let safe = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
        let name: String = id.chars().map(safe).take(60).collect();
        format!("waves/{:03}-{name}.f64", k + 1)
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

/// The content of a wave's file.
pub fn f64_bytes(wave: &Wave) -> Vec<u8> {
    wave.sampled.samples().iter().flat_map(|x| x.to_le_bytes()).collect()
}

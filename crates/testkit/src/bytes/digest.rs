//! Three digests of a file: of its bytes, of its content, and of its content without texts and schemas.

use std::path::Path;

use crumple_artifact::{Artifact, ContentDigest, blake3_text};
use serde_json::Value;

/// Stands where a digest makes no sense.
const NONE: &str = "-";

/// What a line says of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Digests {
    /// Of all bytes; of an artifact without the build of the program that wrote it.
    pub whole: String,
    /// Of the messages (artifacts), or of the value whatever its layout (JSON).
    pub content: String,
    /// The same with [`masked`] texts, and without schemas.
    pub masked: String,
}

impl Digests {
    /// Of what a process printed, and how it ended; only the exit code is left when texts are masked.
    pub fn of_process(code: Option<i32>, printed: &[u8]) -> Self {
        let whole = hex(printed);
        let code = code.map_or_else(|| "signal".to_owned(), |code| format!("exit-{code}"));
        Self { content: whole.clone(), whole, masked: code }
    }
}

fn hex(bytes: &[u8]) -> String {
    blake3_text(bytes).trim_start_matches("blake3:").to_owned()
}

/// Digests of an artifact (`.mcap`), of JSON (`.json`), or of any other file, of which only the bytes count.
///
/// # Errors
/// A file that cannot be read, in words.
pub fn digests_of_file(path: &Path) -> Result<Digests, String> {
    let bytes = std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let whole = hex(&bytes);
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("mcap") => {
            let artifact = Artifact::open(path).map_err(|error| error.to_string())?;
            let build = artifact.provenance().map_or("", |provenance| provenance.build.as_str());
            let whole = hex(&without_build(&bytes, build));
            let content = artifact.digest().trim_start_matches("blake3:").to_owned();
            Ok(Digests { whole, content, masked: masked_artifact(&artifact) })
        }
        Some("json") => {
            let value: Value =
                serde_json::from_slice(&bytes).map_err(|error| format!("{}: {error}", path.display()))?;
            let content = hex(value.to_string().as_bytes());
            Ok(Digests { whole, content, masked: hex(masked(value).to_string().as_bytes()) })
        }
        _ => Ok(Digests { content: whole.clone(), whole, masked: NONE.to_owned() }),
    }
}

/// The bytes of an artifact without the digest of the sources that its writer was built of, and without the checksums
/// that change with it.
fn without_build(bytes: &[u8], build: &str) -> Vec<u8> {
    // Opcodes of the MCAP specification.
    const FOOTER: u8 = 0x02;
    const METADATA: u8 = 0x0c;
    const DATA_END: u8 = 0x0f;
    let mut bytes = bytes.to_vec();
    let mut at = 8;
    while let Some(head) = bytes.get(at..at + 9) {
        let (opcode, length) = (head[0], head[1..].iter().rev().fold(0, |sum, byte| sum << 8 | usize::from(*byte)));
        let start = at + 9;
        let Some(body) = bytes.get_mut(start..start.saturating_add(length)) else { break };
        match opcode {
            FOOTER | DATA_END => {
                let end = body.len().saturating_sub(4);
                body[end..].fill(0);
            }
            METADATA if !build.is_empty() => {
                let place = body.windows(build.len()).position(|part| part == build.as_bytes());
                place.into_iter().for_each(|place| body[place..place + build.len()].fill(b'-'));
            }
            _ => {}
        }
        at = start + length;
    }
    bytes
}

/// A JSON value in which every string with a blank is empty: notes, reasons and definitions are sentences; ids, units,
/// names of models and methods have no blank. The number of texts in a list stays, and so do keys.
pub fn masked(value: Value) -> Value {
    match value {
        Value::String(text) if text.contains(char::is_whitespace) => Value::String(String::new()),
        Value::Array(items) => items.into_iter().map(masked).collect(),
        Value::Object(fields) => Value::Object(fields.into_iter().map(|(key, value)| (key, masked(value))).collect()),
        other => other,
    }
}

/// Records in file order with their texts masked, then the waves as they are.
fn masked_artifact(artifact: &Artifact) -> String {
    let mut digest = ContentDigest::default();
    for record in artifact.records() {
        let payload = match serde_json::from_slice::<Value>(&record.payload) {
            Ok(value) => masked(value).to_string().into_bytes(),
            Err(_) => record.payload.clone(),
        };
        digest.update(&record.topic, &record.schema, &record.encoding, record.log_time, &payload);
    }
    for (id, wave) in artifact.waves() {
        let sampled = &wave.sampled;
        let numbers = [sampled.t0_s(), sampled.dt_s()].into_iter().chain(sampled.samples().iter().copied());
        let payload: Vec<u8> = numbers.flat_map(f64::to_le_bytes).collect();
        digest.update(id, wave.quantity.name(), "wave", 0, &payload);
    }
    digest.text().trim_start_matches("blake3:").to_owned()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_artifact::records::NotesV1;
    use crumple_artifact::{ArtifactBuilder, Compression, Provenance};
    use crumple_signal::{QuantityKind, Sampled};
    use serde_json::json;

    fn artifact_of(build: &str, note: &str, settings: &str, sample: f64) -> Digests {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        let mut builder = ArtifactBuilder::new();
        builder.put("/notes", &NotesV1 { stage: "filter".to_owned(), notes: vec![note.to_owned()] }).unwrap();
        let wave = Sampled::new(0.0, 1e-3, vec![0.0, sample, 2.0]).unwrap();
        builder.wave("a", QuantityKind::Acceleration, wave).unwrap();
        let provenance = Provenance::new("filter", "0", settings.to_owned(), vec![]).with_build(build);
        builder.write(&path, &provenance, Compression::None).unwrap();
        digests_of_file(&path).unwrap()
    }

    fn artifact(note: &str, settings: &str, sample: f64) -> Digests {
        artifact_of("0123456789abcdef", note, settings, sample)
    }

    #[test]
    fn the_build_of_the_program_is_not_part_of_any_digest() {
        let first = artifact("a text", "{}", 1.0);
        assert_eq!(first, artifact_of("fedcba9876543210", "a text", "{}", 1.0));
        assert_ne!(first.whole, artifact_of("", "a text", "{}", 1.0).whole, "whether there is one counts");
    }

    #[test]
    fn settings_texts_and_numbers_of_an_artifact_are_told_apart() {
        let first = artifact("the first text", "{}", 1.0);
        assert_eq!(first, artifact("the first text", "{}", 1.0));
        let other_settings = artifact("the first text", "{\"a\":1}", 1.0);
        assert_ne!(first.whole, other_settings.whole);
        assert_eq!((&first.content, &first.masked), (&other_settings.content, &other_settings.masked));
        let other_text = artifact("the other text", "{}", 1.0);
        assert_ne!(first.content, other_text.content);
        assert_eq!(first.masked, other_text.masked);
        let other_sample = artifact("the first text", "{}", f64::from_bits(1.0_f64.to_bits() + 1));
        assert_ne!(first.masked, other_sample.masked);
    }

    #[test]
    fn texts_are_masked_and_names_and_numbers_are_not() {
        let value =
            json!({"model": "kelvin", "notes": ["one text", "a second text"], "m_kg": 873.0, "of": {"a": "b c"}});
        let expected = json!({"model": "kelvin", "notes": ["", ""], "m_kg": 873.0, "of": {"a": ""}});
        assert_eq!(masked(value), expected);
    }

    #[test]
    fn the_layout_of_json_is_of_the_whole_file_only() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        std::fs::write(&path, "{\"a\": 1}").unwrap();
        let spaced = digests_of_file(&path).unwrap();
        std::fs::write(&path, "{\"a\":1}").unwrap();
        let dense = digests_of_file(&path).unwrap();
        assert_ne!(spaced.whole, dense.whole);
        assert_eq!(spaced.content, dense.content);
    }
}

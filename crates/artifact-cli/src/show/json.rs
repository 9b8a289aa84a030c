//! An artifact as NDJSON.

use std::io::{self, Write};

use crumple_artifact::{Artifact, JsonForm, RawRecord, ReadError, Record, records};

use super::options::{ShowOptions, wanted_waves};

/// Writes records as NDJSON, `{"topic", "schema", "data"}` a line, in file order; with samples asked for, then every
/// waveform as one block.
pub fn write_json(
    artifact: &Artifact,
    options: &ShowOptions,
    out: &mut dyn Write,
) -> Result<io::Result<()>, ReadError> {
    let mut lines = Vec::new();
    for raw in artifact.records().iter().filter(|raw| options.topics.takes(&raw.topic)) {
        if let Some(data) = json_of(artifact, raw, JsonForm::Line)? {
            lines.push(ndjson_line(&raw.topic, &raw.schema, &data));
        }
    }
    if options.samples {
        for (topic, wave) in wanted_waves(artifact, options) {
            let block = records::WaveBlockV1 {
                t0_ns: (wave.sampled.t0_s() * 1e9).round() as i64,
                dt_s: wave.sampled.dt_s(),
                first: 0,
                samples: wave.sampled.samples().to_vec(),
            };
            let data = JsonForm::Line.text(&block).map_err(|problem| message(artifact, &topic, problem))?;
            lines.push(ndjson_line(&topic, records::WaveBlockV1::SCHEMA, &data));
        }
    }
    Ok(lines.iter().try_for_each(|line| writeln!(out, "{line}")))
}

/// `data` is JSON already.
pub(crate) fn ndjson_line(topic: &str, schema: &str, data: &str) -> String {
    let (topic, schema) = (serde_json::Value::from(topic), serde_json::Value::from(schema));
    format!("{{\"topic\":{topic},\"schema\":{schema},\"data\":{data}}}")
}

/// A record as JSON; `None` for an encoding that only its writer knows.
pub(crate) fn json_of(artifact: &Artifact, raw: &RawRecord, form: JsonForm) -> Result<Option<String>, ReadError> {
    if let Some(text) = artifact.json_text(raw, form)? {
        return Ok(Some(text));
    }
    if raw.encoding != "json" {
        return Ok(None);
    }
    let value: serde_json::Value =
        serde_json::from_slice(&raw.payload).map_err(|e| message(artifact, &raw.topic, format!("JSON: {e}")))?;
    form.text(&value).map(Some).map_err(|problem| message(artifact, &raw.topic, problem))
}

fn message(artifact: &Artifact, topic: &str, problem: String) -> ReadError {
    ReadError::Message { path: artifact.path().to_owned(), topic: topic.to_owned(), problem }
}

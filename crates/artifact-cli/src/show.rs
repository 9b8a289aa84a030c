//! Shows an artifact, as text for people or as NDJSON for programs.

use std::io::{self, Write};

use crumple_artifact::records::RemarkV1;
use crumple_artifact::{Artifact, JsonForm, RawRecord, ReadError, Record, WAVE_PREFIX, Wave, records, topic_matches};
use crumple_stage::{is_no_result, remarks_of};

// An artifact as NDJSON.

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

// The remarks of artifacts alone: warnings by weight, then what is good to know, each with its stage.

/// What stages remarked, strongest first, and the codes that a pipeline allows.
#[derive(Debug, Default)]
pub struct StageNotes(Vec<RemarkV1>, Vec<String>);

impl StageNotes {
    /// Gathers the remarks of artifacts, each once, those that change most first: a stage that has nothing to work on
    /// hands on what an earlier one said.
    pub fn of<'a>(artifacts: impl IntoIterator<Item = &'a Artifact>) -> Result<Self, ReadError> {
        let mut all: Vec<RemarkV1> = Vec::new();
        for artifact in artifacts {
            for mut remark in remarks_of(artifact)? {
                // What to do about the others is told by the code.
                remark.remedy = remark.remedy.take().filter(|_| is_no_result(&remark));
                if !all.contains(&remark) {
                    all.push(remark);
                }
            }
        }
        // The sort is stable: equals stay in the order of the stages.
        all.sort_by_key(|remark| std::cmp::Reverse((is_no_result(remark), remark.weight)));
        Ok(Self(all, Vec::new()))
    }

    /// The same with the warnings of a run's `summary.json`, which weighs them by what it shows. Those that its
    /// pipeline allows stand behind them.
    #[must_use]
    pub fn ranked_as(mut self, concerns: Vec<RemarkV1>, allowed: &[String]) -> Self {
        self.0.retain(|remark| !remark.is_warning() || allowed.contains(&remark.code));
        self.0.splice(0..0, concerns);
        self.1 = allowed.to_vec();
        self
    }

    /// A label (mark, weight, stage) and a text for each of them; what to do has no label.
    pub fn lines(&self) -> Vec<(String, String)> {
        let mut lines = Vec::new();
        for remark in &self.0 {
            let RemarkV1 { stage, weight, remedy, .. } = remark;
            if !remark.is_warning() {
                lines.push((format!("{:<11}{stage}", "note"), remark.with_code()));
                continue;
            }
            let mark = match remark {
                remark if is_no_result(remark) => "none",
                remark if self.1.contains(&remark.code) => "allowed",
                _ => "warning",
            };
            lines.push((format!("{mark:<8}{weight:<3}{stage}"), remark.with_code()));
            lines.extend(remedy.iter().map(|remedy| (String::new(), format!("what to do: {remedy}"))));
        }
        lines
    }
}

// What to show of an artifact.

/// Topics to show.
#[derive(Debug, Clone, Default)]
pub struct Wanted(pub Vec<String>);

impl Wanted {
    /// Whether a topic matches one of the patterns; without patterns every topic does.
    pub fn takes(&self, topic: &str) -> bool {
        self.0.is_empty() || self.0.iter().any(|pattern| topic_matches(pattern, topic))
    }
}

/// What is shown.
#[derive(Debug, Clone, Default)]
pub struct ShowOptions {
    /// Of which topics.
    pub topics: Wanted,
    /// Samples of waveforms, too.
    pub samples: bool,
}

/// The waveforms to show, with their topics.
pub(crate) fn wanted_waves<'a>(
    artifact: &'a Artifact,
    options: &'a ShowOptions,
) -> impl Iterator<Item = (String, &'a Wave)> + use<'a> {
    let named = artifact.waves().iter().map(|(id, wave)| (format!("{WAVE_PREFIX}{id}"), wave));
    named.filter(|(topic, _)| options.topics.takes(topic))
}

// An artifact in words: provenance, records as JSON, waveforms as a line each.

/// Writes for people. The outer error is the artifact's, the inner one the writer's.
pub fn write_text(
    artifact: &Artifact,
    options: &ShowOptions,
    out: &mut dyn Write,
) -> Result<io::Result<()>, ReadError> {
    let mut blocks = vec![head(artifact)];
    for raw in artifact.records().iter().filter(|raw| options.topics.takes(&raw.topic)) {
        blocks.push(format!("{}  {}\n{}", raw.topic, raw.schema, body(artifact, raw)?));
    }
    let waves = || wanted_waves(artifact, options).map(|(topic, wave)| format!("{topic}  {}", summary(wave)));
    if options.samples {
        return Ok(blocks.iter().try_for_each(|block| writeln!(out, "{block}\n")).and_then(|()| {
            wanted_waves(artifact, options).zip(waves()).try_for_each(|((_, wave), line)| {
                writeln!(out, "{line}\ntime_s\tvalue")?;
                write_samples(wave, out)?;
                writeln!(out)
            })
        }));
    }
    blocks.extend(Some(waves().collect::<Vec<_>>().join("\n")).filter(|lines| !lines.is_empty()));
    Ok(writeln!(out, "{}", blocks.join("\n\n")))
}

fn body(artifact: &Artifact, raw: &RawRecord) -> Result<String, ReadError> {
    let unread = || format!("{} bytes in encoding {:?}, which is not read", raw.payload.len(), raw.encoding);
    Ok(json_of(artifact, raw, JsonForm::Pretty)?.unwrap_or_else(unread))
}

fn head(artifact: &Artifact) -> String {
    let mut lines = Vec::new();
    match artifact.provenance() {
        None => lines.push("stage    not stated".to_owned()),
        Some(provenance) => {
            let stage = artifact.stage().unwrap_or("not stated");
            lines.push(format!("stage    {stage} {}", provenance.stage_version).trim_end().to_owned());
            if !provenance.made_by.is_empty() {
                lines.push(format!("made by  {}, of content that is not the stage's own", provenance.made_by));
            }
            lines.push(format!("config   {}", provenance.config_json));
            lines.extend(provenance.inputs.iter().map(|input| format!("input    {} {}", input.kind, input.digest)));
        }
    }
    lines.push(format!("content  {}", artifact.digest()));
    lines.join("\n")
}

fn summary(wave: &Wave) -> String {
    let sampled = &wave.sampled;
    let mut text = format!("{} in {}", wave.quantity, wave.quantity.si_unit());
    let samples = sampled.samples();
    let extreme = |better: fn(&f64, &f64) -> bool| {
        (0..samples.len()).reduce(|best, k| if better(&samples[k], &samples[best]) { k } else { best })
    };
    let (Some(low), Some(high)) = (extreme(|x, best| x < best), extreme(|x, best| x > best)) else {
        return format!("{text}, no samples");
    };
    let place = |k: usize| format!("{} at {} s", samples[k], seconds(sampled.time_s(k)));
    text += &format!(
        ", {} samples from {} s to {} s, every {} s ({} Hz); min {}, max {}",
        samples.len(),
        seconds(sampled.t0_s()),
        seconds(sampled.end_s()),
        sampled.dt_s(),
        seconds(sampled.rate_hz()),
        place(low),
        place(high)
    );
    text
}

/// To the nanosecond, in which times are stored.
fn seconds(t_s: f64) -> String {
    let text = format!("{t_s:.9}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn write_samples(wave: &Wave, out: &mut dyn Write) -> io::Result<()> {
    let samples = wave.sampled.samples().iter().zip(wave.sampled.times_s());
    samples.into_iter().try_for_each(|(value, time_s)| writeln!(out, "{}\t{value}", seconds(time_s)))
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn a_note_has_its_stage_in_front() {
        let [stage, text, code] = ["ingest", "a note on one record", "CR101"].map(str::to_owned);
        let notes = StageNotes(vec![RemarkV1 { stage, text, code, ..RemarkV1::default() }], Vec::new());
        assert_eq!(notes.lines(), [("note       ingest".to_owned(), "a note on one record [CR101]".to_owned())]);
    }
}

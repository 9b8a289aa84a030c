//! Two artifacts: topics paired by name, each compared as what it is.

use std::collections::{BTreeMap, BTreeSet};

use crumple_artifact::records::{ConcernsV2, MetricsV2, ModesV2};
use crumple_artifact::{Artifact, JsonForm, RawRecord, ReadError, Record, WAVE_PREFIX, Wave, blake3_text, same_type};
use serde_json::{Value, json};

use crate::CompareSettings;
use crate::compare::json::compare_json;
use crate::compare::provenance::compare_provenance;
use crate::compare::wave::compare_waves;
use crate::differences::{Difference, FileReport, Side, TopicReport};

/// Compares the content of two artifacts; `name` is what the report calls them.
///
/// Encodings, compression, chunking and the order of topics do not count. Equal content digests need no comparison of
/// values. Errors: a record that does not decode.
pub fn compare_artifacts(
    name: &str,
    a: &Artifact,
    b: &Artifact,
    settings: &CompareSettings,
) -> Result<FileReport, ReadError> {
    let provenance = compare_provenance(a.provenance(), b.provenance());
    let topics = if a.digest() == b.digest() { quantities(a, b) } else { topics(a, b, settings)? };
    let same = topics.iter().all(|topic| topic.same) && (provenance.is_empty() || !settings.provenance);
    let digests = Some([a.digest().to_owned(), b.digest().to_owned()]);
    Ok(FileReport { name: name.to_owned(), same, only_in: None, digests, topics, provenance })
}

/// What a waveform measures stands beside the messages, so the digest does not see it.
fn quantities(a: &Artifact, b: &Artifact) -> Vec<TopicReport> {
    let pairs = a.waves().iter().filter_map(|(id, wave)| Some((id, wave.quantity, b.waves().get(id)?.quantity)));
    pairs
        .filter(|(_, a, b)| a != b)
        .map(|(id, a, b)| {
            let mut report = TopicReport::new(&format!("{WAVE_PREFIX}{id}"));
            let (a, b) = (Some(json!(a.name())), Some(json!(b.name())));
            report.differs(Difference { place: "quantity".into(), a, b, ..Difference::default() });
            report
        })
        .collect()
}

/// What stands under a topic. Records of other projects may stand there several times.
enum Content<'a> {
    Wave(&'a Wave),
    Records(Vec<&'a RawRecord>),
}

impl Content<'_> {
    fn kind(&self) -> String {
        match self {
            Self::Wave(wave) => format!("waveform of {} samples", wave.sampled.len()),
            Self::Records(records) => match records.as_slice() {
                [record] => record.schema.clone(),
                more => format!("{} records", more.len()),
            },
        }
    }
}

fn contents(artifact: &Artifact) -> BTreeMap<String, Content<'_>> {
    let mut contents: BTreeMap<String, Content<'_>> = BTreeMap::new();
    for raw in artifact.records() {
        match contents.entry(raw.topic.clone()).or_insert_with(|| Content::Records(Vec::new())) {
            Content::Records(records) => records.push(raw),
            Content::Wave(_) => {}
        }
    }
    contents.extend(artifact.waves().iter().map(|(id, wave)| (format!("{WAVE_PREFIX}{id}"), Content::Wave(wave))));
    contents
}

fn topics(a: &Artifact, b: &Artifact, settings: &CompareSettings) -> Result<Vec<TopicReport>, ReadError> {
    let (left, right) = (contents(a), contents(b));
    let names: BTreeSet<&String> = left.keys().chain(right.keys()).collect();
    let mut reports = Vec::new();
    for topic in names {
        if settings.tolerances.tolerance_of(topic, "", None, None).is_any() {
            continue;
        }
        reports.push(match (left.get(topic), right.get(topic)) {
            (Some(Content::Wave(x)), Some(Content::Wave(y))) => compare_waves(topic, x, y, settings),
            (Some(Content::Records(x)), Some(Content::Records(y))) if x.len() == y.len() => {
                let mut report = TopicReport::new(topic);
                for (x, y) in x.iter().zip(y) {
                    append(&mut report, compare_records((a, x), (b, y), settings)?);
                }
                report
            }
            (Some(x), Some(y)) => {
                let mut report = TopicReport::new(topic);
                let (a, b) = (Some(json!(x.kind())), Some(json!(y.kind())));
                report.differs(Difference { place: "type".into(), a, b, ..Difference::default() });
                report
            }
            (Some(x), None) => TopicReport::only_in(topic, Side::A, &x.kind()),
            (None, Some(y)) => TopicReport::only_in(topic, Side::B, &y.kind()),
            (None, None) => continue,
        });
    }
    Ok(reports)
}

fn append(report: &mut TopicReport, more: TopicReport) {
    report.same &= more.same;
    report.values += more.values;
    report.different += more.different;
    report.saw_rel(more.max_rel);
    report.differences.extend(more.differences);
    report.aside.extend(more.aside);
}

fn compare_records(
    a: (&Artifact, &RawRecord),
    b: (&Artifact, &RawRecord),
    settings: &CompareSettings,
) -> Result<TopicReport, ReadError> {
    let topic = &a.1.topic;
    if a.1.schema != b.1.schema && list_of(a.1).is_none_or(|list| list_of(b.1) != Some(list)) {
        let mut report = TopicReport::new(topic);
        let (a, b) = (Some(json!(a.1.schema)), Some(json!(b.1.schema)));
        report.differs(Difference { place: "schema".into(), a, b, ..Difference::default() });
        return Ok(report);
    }
    Ok(match (json_of(a.0, a.1)?, json_of(b.0, b.1)?) {
        (Some(x), Some(y)) => compare_json(topic, &x, &y, settings),
        _ => compare_bytes(a.1, b.1),
    })
}

/// The list that the record is, and nothing besides: compared as that list, whatever its version.
fn list_of(raw: &RawRecord) -> Option<&'static str> {
    let lists = [(MetricsV2::SCHEMA, "metrics"), (ModesV2::SCHEMA, "modes"), (ConcernsV2::SCHEMA, "concerns")];
    lists.into_iter().find(|(schema, _)| same_type(schema, &raw.schema)).map(|(_, name)| name)
}

/// The record as a value; `None` for an encoding that only its writer knows.
fn json_of(artifact: &Artifact, raw: &RawRecord) -> Result<Option<Value>, ReadError> {
    let message = |problem: String| ReadError::Message {
        path: artifact.path().to_owned(),
        topic: raw.topic.clone(),
        problem: format!("JSON: {problem}"),
    };
    match artifact.json_text(raw, JsonForm::Line)? {
        Some(text) => {
            let mut value: Value = serde_json::from_str(&text).map_err(|error| message(error.to_string()))?;
            let list = list_of(raw).and_then(|name| value.get_mut(name)).map(Value::take);
            Ok(Some(list.unwrap_or(value)))
        }
        None if raw.encoding == "json" => {
            serde_json::from_slice(&raw.payload).map(Some).map_err(|error| message(error.to_string()))
        }
        None => Ok(None),
    }
}

fn compare_bytes(a: &RawRecord, b: &RawRecord) -> TopicReport {
    let mut report = TopicReport::new(&a.topic);
    report.values = 1;
    if (&a.encoding, &a.payload) != (&b.encoding, &b.payload) {
        let text = |raw: &RawRecord| {
            json!(format!("{} bytes of {:?}, {}", raw.payload.len(), raw.encoding, blake3_text(&raw.payload)))
        };
        report.differs(Difference {
            place: "bytes".into(),
            a: Some(text(a)),
            b: Some(text(b)),
            ..Difference::default()
        });
    }
    report
}

//! Two artifacts: topics paired by name, each compared as what it is; waveforms, provenance.

use std::collections::{BTreeMap, BTreeSet};

use crumple_artifact::records::{ConcernsV2, IdentificationV1, MetricsV2, ModesV2, RemarksV1};
use crumple_artifact::{
    Artifact, JsonForm, Provenance, RawRecord, ReadError, Record, WAVE_PREFIX, Wave, blake3_text, same_type,
};
use serde_json::{Value, json};

use crate::allowed::Unit;
use crate::candidate::Candidate;
use crate::differences::{Difference, FileReport, Reason, Side, TopicReport};
use crate::json::{compare_json, leaves};
use crate::tolerances::Base;
use crate::{CompareSettings, Tolerance, Tolerances};

// Two artifacts: topics paired by name, each compared as what it is.

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
    let topics = if a.digest() == b.digest() { quantities_and_units(a, b) } else { topics(a, b, settings)? };
    let same = topics.iter().all(|topic| topic.same) && (provenance.is_empty() || !settings.provenance);
    let digests = Some([a.digest().to_owned(), b.digest().to_owned()]);
    Ok(FileReport { name: name.to_owned(), same, only_in: None, digests, topics, provenance })
}

/// Candidates in two artifacts with a parameter that both sides leave open, and that has another value. Errors: a
/// record that does not decode.
pub fn open_candidates(a: &Artifact, b: &Artifact) -> Result<BTreeSet<String>, ReadError> {
    let mut open = BTreeSet::new();
    for x in a.records() {
        let same_topic = |y: &&RawRecord| y.topic == x.topic;
        let Some(id) = x.topic.strip_prefix("/parameters/") else { continue };
        let Some(y) = b.records().iter().find(same_topic) else { continue };
        if let (Some(Value::Object(x)), Some(Value::Object(y))) = (json_of(a, x)?, json_of(b, y)?)
            && Candidate::from_records("", &x, &y).is_some_and(|candidate| candidate.is_moved())
        {
            open.insert(id.to_owned());
        }
    }
    Ok(open)
}

/// What a waveform measures stands beside the messages, so the digest does not see it.
fn quantities_and_units(a: &Artifact, b: &Artifact) -> Vec<TopicReport> {
    let pairs = a.waves().keys().filter_map(|id| Some((id, Stated::of(a, id)?, Stated::of(b, id)?)));
    pairs
        .filter_map(|(id, a, b)| {
            let mut report = TopicReport::new(&format!("{WAVE_PREFIX}{id}"));
            report.differs(a.difference(b)?);
            Some(report)
        })
        .collect()
}

/// A waveform, and what its metadata say of it.
#[derive(Clone, Copy)]
struct Stated<'a> {
    wave: &'a Wave,
    unit: &'a str,
}

impl<'a> Stated<'a> {
    fn of(artifact: &'a Artifact, id: &str) -> Option<Self> {
        Some(Self { wave: artifact.waves().get(id)?, unit: artifact.unit_of_wave(id)? })
    }

    /// Another quantity; of one quantity another unit.
    fn difference(self, other: Self) -> Option<Difference> {
        let [x, y] = [self, other].map(|side| side.wave.quantity);
        let (place, a, b) = match x == y {
            false => ("quantity", x.name(), y.name()),
            true if self.unit != other.unit => ("unit", self.unit, other.unit),
            true => return None,
        };
        Some(Difference { place: place.into(), a: Some(json!(a)), b: Some(json!(b)), ..Difference::default() })
    }
}

/// What stands under a topic. Records of other projects may stand there several times.
enum Content<'a> {
    Wave(Stated<'a>),
    Records(Vec<&'a RawRecord>),
}

impl Content<'_> {
    /// Samples or values in it; a record that only its writer reads is one value.
    fn size(&self, artifact: &Artifact) -> u64 {
        match self {
            Self::Wave(stated) => stated.wave.sampled.len() as u64,
            Self::Records(records) => {
                let values = |raw: &RawRecord| json_of(artifact, raw).ok().flatten().map_or(1, |value| leaves(&value));
                records.iter().map(|raw| values(raw)).sum()
            }
        }
    }

    fn kind(&self) -> String {
        match self {
            Self::Wave(stated) => format!("waveform of {} samples", stated.wave.sampled.len()),
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
    let waves = artifact.waves().keys().filter_map(|id| Some((id, Stated::of(artifact, id)?)));
    contents.extend(waves.map(|(id, stated)| (format!("{WAVE_PREFIX}{id}"), Content::Wave(stated))));
    contents
}

fn topics(a: &Artifact, b: &Artifact, settings: &CompareSettings) -> Result<Vec<TopicReport>, ReadError> {
    let (left, right) = (contents(a), contents(b));
    let names: BTreeSet<&String> = left.keys().chain(right.keys()).collect();
    let mut reports = Vec::new();
    for topic in names {
        if settings.tolerances.tolerance_of(topic, "", None, None) == Err(Reason::Ignored) {
            let size = |side: Option<&Content<'_>>, artifact| side.map_or(0, |content| content.size(artifact));
            let mut report = TopicReport::new(topic);
            report.leaves_out(Reason::Ignored, size(left.get(topic), a).max(size(right.get(topic), b)));
            reports.push(report);
            continue;
        }
        reports.push(match (left.get(topic), right.get(topic)) {
            (Some(Content::Wave(x)), Some(Content::Wave(y))) => compare_waves(topic, *x, *y, settings),
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
    more.not_compared.iter().for_each(|left| report.leaves_out(left.reason, left.count));
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

/// Remarks as they are compared: by code, equal where subject, weight and values are. Of a sentence without a code, and
/// of sentences among the values, other numbers are no difference, as in notes.
pub fn remarks_by_code(remarks: &Value) -> Value {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let mut all = Vec::new();
    for remark in remarks.as_array().into_iter().flatten() {
        let code = remark["code"].as_str().unwrap_or_default();
        let count = counts.entry(code).or_default();
        *count += 1;
        let id = match (code, *count) {
            ("", n) => format!("without code {n}"),
            (code, 1) => code.to_owned(),
            (code, n) => format!("{code} {n}"),
        };
        let no_values = serde_json::Map::new();
        let stated = remark["values"].as_object().unwrap_or(&no_values);
        // A name is compared as it is, a sentence as notes are.
        let is_sentence = |value: &Value| value.as_str().is_some_and(|text| text.contains(' '));
        let (texts, values): (Vec<_>, Vec<_>) = stated.iter().partition(|(_, value)| is_sentence(value));
        let values: serde_json::Map<String, Value> = values.into_iter().map(|(k, v)| (k.clone(), v.clone())).collect();
        let mut notes: Vec<&Value> = texts.into_iter().map(|(_, text)| text).collect();
        if code.is_empty() {
            notes.push(&remark["text"]);
        }
        let (about, weight) = (&remark["about"], &remark["weight"]);
        all.push(json!({"id": id, "about": about, "weight": weight, "values": values, "notes": notes}));
    }
    Value::from(all)
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
            if same_type(RemarksV1::SCHEMA, &raw.schema) {
                return Ok(Some(remarks_by_code(value.get("remarks").unwrap_or(&value))));
            }
            // They stand in `/remarks` too.
            if same_type(IdentificationV1::SCHEMA, &raw.schema) {
                value.as_object_mut().and_then(|record| record.remove("remarks"));
            }
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

// Provenance: how two results were made, reported beside the differences.

/// Stage, version, options and inputs that differ.
pub(crate) fn compare_provenance(a: Option<&Provenance>, b: Option<&Provenance>) -> Vec<Difference> {
    let (Some(a), Some(b)) = (a, b) else {
        let name = |side: Option<&Provenance>| side.map(|p| json!(format!("{} {}", p.stage, p.stage_version)));
        let only = Difference { a: name(a), b: name(b), ..Difference::default() };
        return if a.is_none() && b.is_none() { Vec::new() } else { vec![only] };
    };
    let exact = CompareSettings {
        tolerances: Tolerances { base: Base::Exact, ..Tolerances::default() },
        ..CompareSettings::default()
    };
    let mut differences = compare_json("provenance", &to_json(a), &to_json(b), &exact).differences;
    for difference in &mut differences {
        // By how much an option differs says nothing.
        (difference.abs, difference.rel) = (None, None);
    }
    differences
}

fn to_json(provenance: &Provenance) -> Value {
    let config: Value =
        serde_json::from_str(&provenance.config_json).unwrap_or_else(|_| provenance.config_json.clone().into());
    // Several inputs of a kind are numbered, the digests being sorted already.
    let mut inputs: BTreeMap<String, Value> = BTreeMap::new();
    for input in &provenance.inputs {
        let count = (1..).find(|n| !inputs.contains_key(&input_name(&input.kind, *n))).unwrap_or(1);
        inputs.insert(input_name(&input.kind, count), json!(input.digest));
    }
    json!({
        "stage": provenance.stage,
        "stage_version": provenance.stage_version,
        "config": config,
        "input": inputs,
    })
}

fn input_name(kind: &str, count: u32) -> String {
    if count == 1 { kind.to_owned() } else { format!("{kind} {count}") }
}

// Waveforms: two series of samples on the same grid.

/// Two grids are the same if no sample's time moves by more than this part of the sampling interval, plus the
/// nanosecond to which the start is stored.
const GRID_PART_OF_INTERVAL: f64 = 1e-6;

const GRID_START_S: f64 = 1e-9;

/// Compares two waveforms: quantity, unit, grid and length first, then sample by sample.
///
/// Relative differences refer to the largest magnitude of both waveforms: a sample near a zero crossing came out of
/// large ones and carries their rounding error. On different grids samples are not compared.
fn compare_waves(topic: &str, a: Stated<'_>, b: Stated<'_>, settings: &CompareSettings) -> TopicReport {
    let mut report = TopicReport::new(topic);
    if let Some(difference) = a.difference(b) {
        report.differs(difference);
    }
    let (a, b) = (a.wave, b.wave);
    let unit = Unit::from_symbol(a.quantity.si_unit());
    let tolerance = settings.tolerances.tolerance_of(topic, "", unit, None);
    let mut frame = |place: &str, a: Value, b: Value| {
        let (abs, rel) = distance(&a, &b);
        report.differs(Difference { place: place.into(), a: Some(a), b: Some(b), abs, rel, ..Difference::default() });
    };
    let (x, y) = (&a.sampled, &b.sampled);
    let slack = |part: f64, fixed: f64| {
        if settings.tolerances.base == Base::Exact { 0.0 } else { part * x.dt_s() + fixed }
    };
    let steps = x.len().max(y.len()).max(1) as f64;
    let same_interval = (x.dt_s() - y.dt_s()).abs() * steps <= slack(GRID_PART_OF_INTERVAL, 0.0);
    let same_start = (x.t0_s() - y.t0_s()).abs() <= slack(GRID_PART_OF_INTERVAL, GRID_START_S);
    if !same_interval {
        frame("dt_s", json!(x.dt_s()), json!(y.dt_s()));
    }
    if !same_start {
        frame("t0_s", json!(x.t0_s()), json!(y.t0_s()));
    }
    if x.len() != y.len() {
        frame("number of samples", json!(x.len()), json!(y.len()));
    }
    let pairs = x.len().min(y.len()) as u64;
    if !(same_interval && same_start) {
        report.leaves_out(Reason::OtherGrid, pairs);
        return report;
    }
    match tolerance {
        Ok(tolerance) => compare_samples(&mut report, a, b, tolerance, settings.bits),
        Err(reason) => report.leaves_out(reason, pairs),
    }
    report
}

/// Adds the samples of two waveforms on one grid.
fn compare_samples(report: &mut TopicReport, a: &Wave, b: &Wave, tolerance: Tolerance, bits: bool) {
    let (x, y) = (a.sampled.samples(), b.sampled.samples());
    let scale = x.iter().chain(y).fold(0.0_f64, |most, value| most.max(value.abs()));
    let allowed = tolerance.abs + tolerance.rel * scale;
    let (mut first, mut worst, mut count) = (None, (0, 0.0), 0_u64);
    for (k, (p, q)) in x.iter().zip(y).enumerate() {
        let distance = (p - q).abs();
        if distance > worst.1 {
            worst = (k, distance);
        }
        if distance > allowed || (bits && p.to_bits() != q.to_bits()) {
            first = first.or(Some(k));
            count += 1;
        }
    }
    let relative = |distance: f64| if distance == 0.0 { 0.0 } else { distance / scale };
    report.values = x.len().min(y.len()) as u64;
    report.max_abs = Some(worst.1);
    report.max_rel = Some(relative(worst.1));
    if let Some(first) = first {
        let at = |k: usize| {
            let distance = (x[k] - y[k]).abs();
            Difference {
                place: format!("sample {k}"),
                a: Some(json!(x[k])),
                b: Some(json!(y[k])),
                abs: Some(distance),
                rel: Some(relative(distance)),
                sample: Some(k as u64),
                time_s: Some(a.sampled.time_s(k)),
                ..Difference::default()
            }
        };
        report.differs(at(first));
        if worst.1 > (x[first] - y[first]).abs() {
            report.differences.push(at(worst.0));
        }
        report.different += count - 1;
    }
}

fn distance(a: &Value, b: &Value) -> (Option<f64>, Option<f64>) {
    match (a.as_f64(), b.as_f64()) {
        (Some(a), Some(b)) => (Some((a - b).abs()), Some((a - b).abs() / a.abs().max(b.abs()).max(f64::MIN_POSITIVE))),
        _ => (None, None),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;
    use std::path::Path;

    use super::*;
    use crumple_artifact::{ArtifactBuilder, Compression, InputDigest};
    use crumple_signal::{QuantityKind, Sampled};

    #[test]
    fn changed_options_versions_and_inputs_are_named() {
        let make = |version: &str, cfc: u16, digest: &str| {
            let input = InputDigest { kind: "ingest".into(), digest: digest.into() };
            Provenance::new("filter", version, format!(r#"{{"cfc":{cfc}}}"#), vec![input])
        };
        let (a, b) = (make("0.1.0", 60, "blake3:00"), make("0.2.0", 180, "blake3:11"));
        let places = |differences: Vec<Difference>| differences.into_iter().map(|d| d.place).collect::<Vec<_>>();
        assert_eq!(places(compare_provenance(Some(&a), Some(&b))), ["config.cfc", "input.ingest", "stage_version"]);
        assert!(compare_provenance(Some(&a), Some(&a)).is_empty());
        assert_eq!(places(compare_provenance(Some(&a), None)), [""]);
    }

    fn wave(t0_s: f64, samples: Vec<f64>) -> Wave {
        Wave { quantity: QuantityKind::Acceleration, sampled: Sampled::new(t0_s, 0.5, samples).unwrap() }
    }

    fn compare(a: &Wave, b: &Wave) -> TopicReport {
        compare_with(a, b, &CompareSettings::default())
    }

    fn compare_with(a: &Wave, b: &Wave, settings: &CompareSettings) -> TopicReport {
        let stated = |wave| Stated { wave, unit: "m/s^2" };
        compare_waves("/wave/93", stated(a), stated(b), settings)
    }

    #[test]
    fn names_the_first_and_the_worst_sample() {
        let a = wave(-1.0, vec![0.0, 100.0, -200.0, 50.0]);
        let b = wave(-1.0, vec![0.0, 101.0, -200.0, 54.0]);
        let report = compare(&a, &b);
        assert_eq!((report.values, report.different), (4, 2));
        assert_eq!((report.max_abs, report.max_rel), (Some(4.0), Some(0.02)));
        let first = &report.differences[0];
        assert_eq!((first.sample, first.time_s, first.abs, first.rel), (Some(1), Some(-0.5), Some(1.0), Some(0.005)));
        assert_eq!((first.a.clone(), first.b.clone()), (Some(json!(100.0)), Some(json!(101.0))));
        assert_eq!(report.differences[1].sample, Some(3));
    }

    #[test]
    fn rounding_near_a_zero_crossing_is_no_difference_and_exact_sees_it() {
        let (a, b) = (wave(0.0, vec![200.0, 1e-15]), wave(0.0, vec![200.0, -1e-15]));
        let report = compare(&a, &b);
        assert!(report.same);
        assert_eq!(report.max_abs, Some(2e-15));
        let exact = Tolerances { base: Base::Exact, ..Tolerances::default() };
        let settings = CompareSettings { tolerances: exact, ..CompareSettings::default() };
        assert_eq!(compare_with(&a, &b, &settings).different, 1);
    }

    #[test]
    fn another_grid_length_or_quantity_is_named() {
        let a = wave(0.0, vec![1.0, 2.0]);
        let places = |b: &Wave| compare(&a, b).differences.iter().map(|d| d.place.clone()).collect::<Vec<_>>();
        assert_eq!(places(&wave(0.1, vec![1.0, 9.0])), ["t0_s"]);
        assert_eq!(places(&wave(0.0, vec![1.0, 2.0, 3.0])), ["number of samples"]);
        assert_eq!(places(&wave(0.0, vec![1.5])), ["number of samples", "sample 0"]);
        let other = Wave { quantity: QuantityKind::Velocity, ..a.clone() };
        assert_eq!(places(&other), ["quantity"]);
        assert!(places(&wave(1e-10, vec![1.0, 2.0])).is_empty(), "below the resolution of the stored start");
    }

    #[test]
    fn empty_waveforms_are_the_same() {
        assert!(compare(&wave(0.0, vec![]), &wave(0.0, vec![])).same);
    }

    /// A file with one waveform, whose metadata state a quantity and a unit.
    fn file(quantity: QuantityKind, unit: &str) -> Artifact {
        let mut builder = ArtifactBuilder::new();
        builder.wave("93", quantity, Sampled::new(0.0, 0.5, vec![1.0, 2.0]).unwrap()).unwrap();
        let mut written = Cursor::new(Vec::new());
        let provenance = Provenance::new("mine", "1", "{}".into(), Vec::new());
        builder.write_to(&mut written, &provenance, Compression::None).unwrap();
        let mut file = Cursor::new(Vec::new());
        let mut writer = mcap::WriteOptions::new().create(&mut file).unwrap();
        for message in mcap::MessageStream::new(written.get_ref()).unwrap() {
            let mut message = message.unwrap();
            let channel = std::sync::Arc::make_mut(&mut message.channel);
            channel.metadata.insert("unit".into(), unit.into());
            writer.write(&message).unwrap();
        }
        writer.finish().unwrap();
        drop(writer);
        Artifact::read(Path::new("x.mcap"), file.get_ref().as_slice()).unwrap()
    }

    #[test]
    fn another_unit_is_a_difference_and_another_spelling_is_none() {
        let differences = |a: &Artifact, b: &Artifact| -> Vec<Difference> {
            assert_eq!(a.digest(), b.digest(), "the digest does not see it");
            let report = compare_artifacts("x.mcap", a, b, &CompareSettings::default()).unwrap();
            report.topics.into_iter().flat_map(|topic| topic.differences).collect()
        };
        let other = |unit| file(QuantityKind::Other, unit);
        let found = differences(&other("V"), &other("mV"));
        let expected =
            Difference { place: "unit".into(), a: Some(json!("V")), b: Some(json!("mV")), ..Difference::default() };
        assert_eq!(found, [expected]);
        assert!(differences(&other("V"), &other("V")).is_empty());
        let spelled = |unit| file(QuantityKind::Acceleration, unit);
        assert!(differences(&spelled("m/s^2"), &spelled("m/s2")).is_empty());
        assert!(differences(&spelled("m/s^2"), &spelled("")).is_empty());
    }

    #[test]
    fn samples_that_are_not_compared_are_counted() {
        let count = |report: TopicReport| report.not_compared.iter().map(|left| (left.reason, left.count)).next();
        let (a, b) = (wave(0.0, vec![1.0, 2.0]), wave(0.1, vec![1.0, 9.0]));
        assert_eq!(count(compare(&a, &b)), Some((Reason::OtherGrid, 2)));
        let stated = |wave| Stated { wave, unit: "m/s^2" };
        let (topic, b) = ("/wave/nonlinear-2/direct-fit/1/acceleration", wave(0.0, vec![1.0, 9.0, 9.0]));
        let mut settings = CompareSettings::default();
        settings.tolerances.open.insert("nonlinear-2/direct-fit/1".into());
        let report = compare_waves(topic, stated(&a), stated(&b), &settings);
        assert_eq!(report.differences[0].place, "number of samples");
        assert_eq!(count(report), Some((Reason::FollowsOpenParameter, 2)));
        assert_eq!(
            count(compare_waves("/wave/nonlinear-2/direct-fit/11/acceleration", stated(&a), stated(&b), &settings)),
            None
        );
        // A topic that the user ignores is counted as a whole.
        settings.tolerances.rules = crate::parse_rules("\"/wave/*\" = { ignore = true }").unwrap();
        let [a, b] = ["V", "mV"].map(|unit| file(QuantityKind::Other, unit));
        let [first] = topics(&a, &b, &settings).unwrap().try_into().unwrap();
        assert!(first.same && !first.is_compared());
        assert_eq!(count(first), Some((Reason::Ignored, 2)));
    }
}

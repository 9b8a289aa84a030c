//! MCAP files: recordings of sensors, and artifacts of this project's stages.

use std::collections::BTreeMap;
use std::path::Path;

use crumple_artifact::Artifact;
use crumple_artifact::records::TestV1;
use crumple_signal::unit::signal_unit;
use crumple_signal::{Channel, Notes, QuantityKind, TestDescription};
use mcap::records::{Channel as McapChannel, Record as McapRecord};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::bundle::Bundle;
use crate::messages::{self, Component, Sample, Topic, Track, imu_components, is_imu, json_number, json_stamp_ns};
use crate::recognise::Reader;
use crate::recording::{Details, Fitness, Found, PulseRule, Recording, Stated};
use crate::{IngestError, Place, Settings};

/// Largest chunk that is unpacked, bytes.
const CHUNK_LIMIT: u64 = 1 << 28;

/// Reader of MCAP files.
pub struct Mcap;

impl Reader for Mcap {
    fn format(&self) -> &'static str {
        "mcap"
    }

    fn recognises(&self, head: &[u8]) -> bool {
        head.starts_with(b"\x89MCAP0\r\n")
    }

    fn read(&self, bundle: &Bundle, settings: &Settings) -> Result<Recording, IngestError> {
        let (file, bytes) = (bundle.main.name.as_str(), bundle.main.bytes.as_slice());
        let topics = topics(file, bytes)?;
        if topics.get("/test").is_some_and(|t| t.kind.starts_with("crumple.Test.v")) {
            return of_artifact(file, bytes);
        }
        of_messages(file, bytes, &topics, settings)
    }
}

fn damaged(file: &str, found: &str) -> IngestError {
    IngestError::content(
        Place::file(file),
        format!("the MCAP file cannot be read: {found}"),
        "a complete file",
        "it may be cut short or damaged: record or copy it again, or repair it with \"mcap recover\"",
    )
}

/// Tells `each` all records of the file; chunks as they are (`unpack` false), or the records in them. No record may be longer
/// than [`CHUNK_LIMIT`], whatever it claims.
fn scan(
    file: &str,
    bytes: &[u8],
    unpack: bool,
    mut each: impl FnMut(McapRecord) -> Result<(), IngestError>,
) -> Result<(), IngestError> {
    let mut reader = LinearReader::new_with_options(
        LinearReaderOptions::default()
            .with_emit_chunks(!unpack)
            .with_validate_chunk_crcs(true)
            .with_record_length_limit(CHUNK_LIMIT as usize),
    );
    let mut rest = bytes;
    while let Some(event) = reader.next_event() {
        match event.map_err(|error| damaged(file, &error.to_string()))? {
            LinearReadEvent::ReadRequest(need) => {
                // In pieces, so that an absurd announced length reserves nothing.
                let length = need.min(rest.len()).min(1 << 24);
                reader.insert(length).copy_from_slice(&rest[..length]);
                reader.notify_read(length);
                rest = &rest[length..];
            }
            LinearReadEvent::Record { opcode, data } => {
                each(mcap::parse_record(opcode, data).map_err(|error| damaged(file, &error.to_string()))?)?;
            }
        }
    }
    Ok(())
}

/// Tells `each` topic, type, encoding, log time in ns and bytes of every message.
fn messages_of(
    file: &str,
    bytes: &[u8],
    mut each: impl FnMut(&str, &str, &str, u64, &[u8]),
) -> Result<(), IngestError> {
    let mut schemas: BTreeMap<u16, String> = BTreeMap::new();
    let mut channels: BTreeMap<u16, McapChannel> = BTreeMap::new();
    scan(file, bytes, true, |record| {
        match record {
            McapRecord::Schema { header, .. } => drop(schemas.insert(header.id, header.name)),
            McapRecord::Channel(channel) => drop(channels.insert(channel.id, channel)),
            McapRecord::Message { header, data } => {
                let channel = channels.get(&header.channel_id).ok_or_else(|| {
                    damaged(
                        file,
                        &format!("a message of channel {}, which is not described before it", header.channel_id),
                    )
                })?;
                let kind = schemas.get(&channel.schema_id).map_or("", String::as_str);
                each(&channel.topic, kind, &channel.message_encoding, header.log_time, &data);
            }
            _ => {}
        }
        Ok(())
    })
}

/// All topics with their counts; chunks that claim to be huge are refused before anything is unpacked.
fn topics(file: &str, bytes: &[u8]) -> Result<BTreeMap<String, Topic>, IngestError> {
    let mut total = 0_u64;
    scan(file, bytes, false, |record| {
        let McapRecord::Chunk { header, .. } = record else { return Ok(()) };
        total = total.saturating_add(header.uncompressed_size);
        if header.uncompressed_size > CHUNK_LIMIT {
            return Err(IngestError::TooLarge {
                place: Place::file(file),
                found: format!("a chunk that claims {} MiB when unpacked", header.uncompressed_size >> 20),
                limit: format!("chunks up to {} MiB", CHUNK_LIMIT >> 20),
            });
        }
        crate::bundle::check_total(file, total)
    })?;
    let mut topics: BTreeMap<String, Topic> = BTreeMap::new();
    messages_of(file, bytes, |topic, kind, encoding, _, _| {
        let known = topics.entry(topic.to_owned()).or_insert_with(|| Topic {
            kind: kind.to_owned(),
            encoding: encoding.to_owned(),
            count: 0,
        });
        known.count += 1;
    })?;
    Ok(topics)
}

/// `--field`: a path, or several separated by commas, each with its topic and a colon in front if more than one topic has it.
struct Field<'a> {
    topic: Option<&'a str>,
    path: &'a str,
}

fn fields(text: &str) -> Vec<Field<'_>> {
    text.split(',')
        .map(|field| match field.trim().rsplit_once(':') {
            Some((topic, path)) => Field { topic: Some(topic), path },
            None => Field { topic: None, path: field.trim() },
        })
        .collect()
}

fn of_messages(
    file: &str,
    bytes: &[u8],
    topics: &BTreeMap<String, Topic>,
    settings: &Settings,
) -> Result<Recording, IngestError> {
    let mut notes = Notes::new();
    let named = settings.field.as_deref().map(fields).unwrap_or_default();
    let mut tracks: BTreeMap<String, Track> = BTreeMap::new();
    let mut unread: BTreeMap<String, u64> = BTreeMap::new();
    let mut by_log_time = false;
    let wanted = |name: &str, topic: &Topic| -> Option<(Vec<Component>, Vec<String>)> {
        if named.is_empty() {
            let readable = matches!(topic.encoding.as_str(), "cdr" | "ros1" | "json");
            let paths = ["linear_acceleration", "angular_velocity"]
                .iter()
                .flat_map(|field| ["x", "y", "z"].map(|axis| format!("{field}.{axis}")))
                .collect();
            return (is_imu(&topic.kind) && readable).then(|| (imu_components(), paths));
        }
        let mine: Vec<&Field> = named.iter().filter(|f| f.topic.is_none_or(|t| t == name)).collect();
        let (quantity, factor) = settings.unit.as_deref().and_then(signal_unit).unwrap_or((QuantityKind::Other, 1.0));
        let component = |f: &&Field| Component { name: f.path.to_owned(), quantity, axis: None, factor };
        (topic.encoding == "json" && !mine.is_empty())
            .then(|| (mine.iter().map(component).collect(), mine.iter().map(|f| f.path.to_owned()).collect()))
    };
    let plans: BTreeMap<&str, (Vec<Component>, Vec<String>)> =
        topics.iter().filter_map(|(name, topic)| Some((name.as_str(), wanted(name, topic)?))).collect();
    messages_of(file, bytes, |topic, _, encoding, log_time, data| {
        let Some((components, paths)) = plans.get(topic) else { return };
        let sample = match encoding {
            "json" => serde_json::from_slice(data).ok().and_then(|json: serde_json::Value| {
                let values = paths.iter().map(|path| json_number(&json, path)).collect::<Option<Vec<f64>>>()?;
                let stamp_ns = json_stamp_ns(&json);
                by_log_time |= stamp_ns.is_none();
                let stamp_ns = stamp_ns.or_else(|| i64::try_from(log_time).ok())?;
                Some(Sample { stamp_ns, values })
            }),
            encoding => messages::imu(data, encoding == "cdr"),
        };
        match sample {
            Some(sample) => {
                let track = tracks
                    .entry(topic.to_owned())
                    .or_insert_with(|| Track { components: components.clone(), samples: Vec::new() });
                track.samples.push(sample);
            }
            None => *unread.entry(topic.to_owned()).or_default() += 1,
        }
    })?;
    if tracks.is_empty() {
        return Err(nothing(file, topics, &named, &unread));
    }
    for (topic, count) in unread.iter().filter(|(topic, _)| tracks.contains_key(*topic)) {
        notes.warning(format!("topic {topic}: {count} messages do not hold the fields and are left out"));
    }
    if by_log_time {
        notes.warning("messages without header.stamp: the time of recording is taken for the time of measurement");
    }
    if !named.is_empty() && settings.unit.as_deref().and_then(signal_unit).is_none() {
        notes.warning(
            "no unit is known for the fields: kept as read, quantity other; --unit m/s^2 or --unit g states it",
        );
    }
    messages::recording(file, &tracks, settings, notes)
}

fn nothing(
    file: &str,
    topics: &BTreeMap<String, Topic>,
    named: &[Field],
    unread: &BTreeMap<String, u64>,
) -> IngestError {
    if let Some(field) = named.first() {
        let found = format!("no JSON message has a number at {}", field.path);
        return messages::refuse(file, topics, &found, "correct --field, such as --field imu.acceleration.x");
    }
    if let Some((topic, count)) = unread.iter().next() {
        let found = format!("none of the {count} messages of {topic} holds linear acceleration");
        return messages::refuse(file, topics, &found, "export the channels as CSV");
    }
    let hint = if topics.values().any(|t| is_imu(&t.kind) || t.encoding == "protobuf") {
        "its encoding is not read (cdr, ros1 and json are): export the acceleration as CSV, or record it in one of them"
    } else if topics.values().any(|t| t.encoding == "json") {
        "name the acceleration by --field, such as --field imu.acceleration.x, and its unit by --unit"
    } else {
        "export the acceleration as CSV: time and acceleration columns with their units in the header"
    };
    messages::refuse(file, topics, "no topic with acceleration", hint)
}

/// The test and the waves of an artifact of any stage, as they are.
fn of_artifact(file: &str, bytes: &[u8]) -> Result<Recording, IngestError> {
    let refuse = |found: String| {
        IngestError::content(
            Place::file(file),
            found,
            "an artifact as docs/format.md describes it",
            "check it with crumple-artifact check",
        )
    };
    let artifact = Artifact::read(Path::new(file), bytes).map_err(|error| refuse(error.to_string()))?;
    let test: TestV1 = artifact
        .record("/test")
        .map_err(|error| refuse(error.to_string()))?
        .ok_or_else(|| refuse("no record under /test".to_owned()))?;
    let test = TestDescription::try_from(test).map_err(|error| refuse(error.to_string()))?;
    let mut notes = Notes::new();
    notes.info(format!(
        "read from an artifact of {}: channels and samples are as that stage left them",
        artifact.stage().unwrap_or("a stage that does not say its name")
    ));
    let from = || format!("/test of {file}");
    let stated = |value: f64| Stated { value, from: from() };
    let words = |value: &Option<String>| value.clone().map(|value| Stated { value, from: from() });
    let mut facts = test.notes.clone();
    facts.push(format!("first read from {} ({})", test.source.name, test.source.format));
    let details = Details {
        title: Some(Stated { value: test.title.clone(), from: from() }),
        vehicle: words(&test.vehicle),
        barrier: words(&test.barrier),
        mass_kg: test.mass_kg.map(stated),
        impact_speed_m_per_s: test.impact_speed_m_per_s.map(stated),
        time_zero_s: None,
        no_pulse: false,
        facts,
    };
    let found = |channel: Channel| {
        let wave = artifact.waves().get(&channel.id).filter(|w| w.quantity == channel.quantity);
        let is_pulse = test.pulse.as_deref() == Some(channel.id.as_str());
        let fitness = (channel.quantity == QuantityKind::Acceleration && (is_pulse || test.pulse.is_none()))
            .then_some(Fitness { redundant: false, place: 0, why: "the pulse of the artifact" });
        Found { wave: wave.map(|w| w.sampled.clone()), jitter: 0.0, fitness, aliases: Vec::new(), channel }
    };
    let mut channels: Vec<Found> = test.channels.iter().cloned().map(found).collect();
    for (id, wave) in artifact.waves() {
        if !test.channels.iter().any(|c| c.id == *id && c.quantity == wave.quantity) {
            // A wave that the test does not list, or lists as something else, such as a displacement of the pulse.
            let taken = channels.iter().any(|f| f.channel.id == *id);
            let name = if taken { format!("{id}-{}", wave.quantity) } else { id.clone() };
            let mut extra = found(Channel::new(name, wave.quantity));
            extra.wave = Some(wave.sampled.clone());
            channels.push(extra);
        }
    }
    let pulse_rule = if test.pulse.is_some() { PulseRule::Fittest } else { PulseRule::OnlyOne };
    Ok(Recording { details, channels, pulse_rule, contact_at_zero: true, notes })
}

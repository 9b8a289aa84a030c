//! MCAP files: recordings of sensors, and artifacts of this project's stages.

use std::collections::BTreeMap;
use std::path::Path;

use crumple_artifact::records::TestV1;
use crumple_artifact::{Artifact, add_decompressors};
use crumple_signal::unit::signal_unit;
use crumple_signal::{About, Channel, Notes, QuantityKind, TestDescription, Weight, remarks};
use mcap::records::{Channel as McapChannel, Record as McapRecord};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::formats::messages::{
    self, Component, StampedSample, Topic, Track, imu_components, is_imu, json_number, json_stamp_ns,
};
use crate::formats::protobuf;
use crate::formats::protobuf::Decoder;
use crate::formats::reader::{Bundle, Reader, check_total};
use crate::formats::remarks::UnitNotStated;
use crate::recording::content::{Fitness, PulseRule, ReadChannel, Recording};
use crate::recording::details::{Details, Stated};
use crate::recording::settings;
use crate::{IngestError, IngestSettings, Result, check_size};

/// Largest chunk that is unpacked, bytes.
const CHUNK_LIMIT: u64 = 1 << 28;

pub const MCAP: Reader =
    Reader::of_one_file("mcap", |head| head.starts_with(b"\x89MCAP0\r\n"), &["--unit", "--field", "--resample"], read);

fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording> {
    let (file, bytes) = (bundle.main.name.as_str(), bundle.main.bytes.as_slice());
    let topics = topics(file, bytes)?;
    if topics.get("/test").is_some_and(|t| t.kind.starts_with("crumple.Test.v")) {
        let mut recording = read_artifact(file, bytes)?;
        let why = "channels and samples of an artifact are as its stage left them";
        settings::warn_except(settings, MCAP.relevant_flags, why, &mut recording.notes);
        return Ok(recording);
    }
    read_messages(file, bytes, &topics, settings)
}

fn damaged(file: &str, found: impl std::fmt::Display) -> IngestError {
    IngestError::content(
        file,
        format!("the MCAP file cannot be read: {found}"),
        "a complete file",
        "it may be cut short or damaged: record or copy it again, or repair it with \"mcap recover\"",
    )
}

/// Tells `each` all records of the file; chunks as they are (`unpack` false), or the records in them. No record may be
/// longer than [`CHUNK_LIMIT`], whatever it claims.
fn scan(file: &str, bytes: &[u8], unpack: bool, mut each: impl FnMut(McapRecord) -> Result<()>) -> Result<()> {
    let mut reader = LinearReader::new_with_options(
        LinearReaderOptions::default()
            .with_emit_chunks(!unpack)
            .with_validate_chunk_crcs(true)
            .with_record_length_limit(CHUNK_LIMIT as usize),
    );
    add_decompressors(&mut reader, CHUNK_LIMIT).map_err(|error| damaged(file, error))?;
    let mut rest = bytes;
    while let Some(event) = reader.next_event() {
        match event.map_err(|error| damaged(file, error))? {
            LinearReadEvent::ReadRequest(need) => {
                // In pieces, so that an absurd announced length reserves nothing.
                let length = need.min(rest.len()).min(1 << 24);
                reader.insert(length).copy_from_slice(&rest[..length]);
                reader.notify_read(length);
                rest = &rest[length..];
            }
            LinearReadEvent::Record { opcode, data } => {
                each(mcap::parse_record(opcode, data).map_err(|error| damaged(file, error))?)?;
            }
        }
    }
    Ok(())
}

/// Refuses a plain chunk in which a record is longer than what is left of it.
fn require_whole_records(file: &str, record: &McapRecord) -> Result<()> {
    let McapRecord::Chunk { header, data } = record else { return Ok(()) };
    let mut rest: &[u8] = if header.compression.is_empty() { data } else { &[] };
    while !rest.is_empty() {
        let length = rest.get(1..9).and_then(|length| length.try_into().ok()).map(u64::from_le_bytes);
        let end = length.and_then(|length| usize::try_from(length).ok()).and_then(|length| length.checked_add(9));
        rest = end.and_then(|end| rest.get(end..)).ok_or_else(|| damaged(file, "a record is longer than its chunk"))?;
    }
    Ok(())
}

/// The type of a topic's messages, and the description of it that the file carries.
#[derive(Default)]
struct Kind {
    name: String,
    description: Vec<u8>,
}

struct Message<'a> {
    topic: &'a str,
    /// Number of the type in the file.
    schema: u16,
    kind: &'a Kind,
    encoding: &'a str,
    log_time_ns: u64,
    data: &'a [u8],
}

/// Tells `each` every message.
fn messages_of(file: &str, bytes: &[u8], mut each: impl FnMut(Message)) -> Result<()> {
    let unknown = Kind::default();
    let mut schemas: BTreeMap<u16, Kind> = BTreeMap::new();
    let mut channels: BTreeMap<u16, McapChannel> = BTreeMap::new();
    scan(file, bytes, true, |record| {
        match record {
            McapRecord::Schema { header, data } => {
                schemas.insert(header.id, Kind { name: header.name, description: data.into_owned() });
            }
            McapRecord::Channel(channel) => drop(channels.insert(channel.id, channel)),
            McapRecord::Message { header, data } => {
                let channel = channels.get(&header.channel_id).ok_or_else(|| {
                    damaged(
                        file,
                        format!("a message of channel {}, which is not described before it", header.channel_id),
                    )
                })?;
                each(Message {
                    topic: &channel.topic,
                    schema: channel.schema_id,
                    kind: schemas.get(&channel.schema_id).unwrap_or(&unknown),
                    encoding: &channel.message_encoding,
                    log_time_ns: header.log_time,
                    data: &data,
                });
            }
            _ => {}
        }
        Ok(())
    })
}

/// All topics with their counts; chunks that claim to be huge are refused before anything is unpacked.
fn topics(file: &str, bytes: &[u8]) -> Result<BTreeMap<String, Topic>> {
    let mut total = 0_u64;
    scan(file, bytes, false, |record| {
        // The reader counts on it when it unpacks (mcap 0.26).
        require_whole_records(file, &record)?;
        let McapRecord::Chunk { header, .. } = record else { return Ok(()) };
        total = total.saturating_add(header.uncompressed_size);
        let (claimed, found) = (header.uncompressed_size, "a chunk that claims # MiB when unpacked");
        check_size(file, claimed, CHUNK_LIMIT, found, "chunks up to # MiB")?;
        let limit = "chunks up to the # MiB left of the memory limit (--memory-limit)";
        check_size(file, claimed, crumple_memory::left(), found, limit)?;
        check_total(file, total)
    })?;
    let mut topics: BTreeMap<String, Topic> = BTreeMap::new();
    messages_of(file, bytes, |message| {
        let known = topics.entry(message.topic.to_owned()).or_insert_with(|| Topic {
            kind: message.kind.name.clone(),
            encoding: message.encoding.to_owned(),
            count: 0,
        });
        known.count += 1;
    })?;
    Ok(topics)
}

/// `--field`: a path, or several separated by commas, each with its topic and a colon in front if more than one topic
/// has it.
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

/// What is taken from the messages of a topic: its components, and where they stand.
type Plan = (Vec<Component>, Vec<String>);

/// What to take from a topic: the fields named, else what an IMU measures. `None`: nothing.
fn plan(name: &str, topic: &Topic, named: &[Field], unit: Option<(QuantityKind, f64)>) -> Option<Plan> {
    if named.is_empty() {
        let readable = matches!(topic.encoding.as_str(), "cdr" | "ros1" | "json");
        let paths = ["linear_acceleration", "angular_velocity"]
            .iter()
            .flat_map(|field| ["x", "y", "z"].map(|axis| format!("{field}.{axis}")))
            .collect();
        return (is_imu(&topic.kind) && readable).then(|| (imu_components(), paths));
    }
    let of_topic: Vec<&Field> = named.iter().filter(|f| f.topic.is_none_or(|t| t == name)).collect();
    let (quantity, factor) = unit.unwrap_or((QuantityKind::Other, 1.0));
    let component = |f: &&Field| Component { name: f.path.to_owned(), quantity, axis: None, factor };
    (matches!(topic.encoding.as_str(), "json" | "protobuf") && !of_topic.is_empty())
        .then(|| (of_topic.iter().map(component).collect(), of_topic.iter().map(|f| f.path.to_owned()).collect()))
}

fn unit_of_fields(file: &str, settings: &IngestSettings) -> Result<Option<(QuantityKind, f64)>> {
    let Some(symbol) = settings.unit.as_deref().filter(|_| settings.field.is_some()) else { return Ok(None) };
    signal_unit(symbol).map(Some).ok_or_else(|| {
        IngestError::content(
            file,
            format!("{symbol:?}, stated by --unit, is no unit known here"),
            "a unit such as m/s^2, g, rad/s or N",
            "correct --unit, or leave it away: the fields are then kept as read",
        )
    })
}

/// A protobuf type and the ways to the fields in it; `None` if one leads nowhere.
type Protobuf = (Decoder, Option<Vec<protobuf::Path>>);

/// Messages read, and what stood in the way of others.
#[derive(Default)]
struct Collected {
    tracks: BTreeMap<String, Track>,
    unread: BTreeMap<String, u64>,
    by_log_time: bool,
    /// By the number of the type; or what is wrong with its schema.
    decoders: BTreeMap<u16, Result<Protobuf, String>>,
}

impl Collected {
    fn take(&mut self, message: &Message, (components, paths): &Plan) {
        let sample = match message.encoding {
            "json" => serde_json::from_slice(message.data).ok().and_then(|json: serde_json::Value| {
                let values = paths.iter().map(|path| json_number(&json, path)).collect::<Option<Vec<f64>>>()?;
                self.stamped(json_stamp_ns(&json), message.log_time_ns, values)
            }),
            "protobuf" => self.decoded(message, paths),
            encoding => messages::imu(message.data, encoding == "cdr", message.log_time_ns.cast_signed()),
        };
        match sample {
            Some(sample) => {
                let track = self
                    .tracks
                    .entry(message.topic.to_owned())
                    .or_insert_with(|| Track { components: components.clone(), samples: Vec::new() });
                track.samples.push(sample);
            }
            None => *self.unread.entry(message.topic.to_owned()).or_default() += 1,
        }
    }

    fn decoded(&mut self, message: &Message, paths: &[String]) -> Option<StampedSample> {
        let decoder = self.decoders.entry(message.schema).or_insert_with(|| {
            let decoder = Decoder::new(&message.kind.name, &message.kind.description)?;
            let ways = paths.iter().map(|path| decoder.path(path)).collect();
            Ok((decoder, ways))
        });
        let (decoder, ways) = decoder.as_ref().ok()?;
        let values = ways.as_ref()?.iter().map(|way| protobuf::number(message.data, way)).collect::<Option<_>>()?;
        let stamp = decoder.stamp_ns(message.data);
        self.stamped(stamp, message.log_time_ns, values)
    }

    fn stamped(&mut self, own: Option<i64>, log_time_ns: u64, values: Vec<f64>) -> Option<StampedSample> {
        self.by_log_time |= own.is_none();
        let recorded_ns = log_time_ns.cast_signed();
        let stamp_ns = own.or_else(|| i64::try_from(log_time_ns).ok())?;
        Some(StampedSample { stamp_ns, recorded_ns, values })
    }
}

fn read_messages(
    file: &str,
    bytes: &[u8],
    topics: &BTreeMap<String, Topic>,
    settings: &IngestSettings,
) -> Result<Recording> {
    let mut notes = Notes::new();
    let named = settings.field.as_deref().map(fields).unwrap_or_default();
    let unit = unit_of_fields(file, settings)?;
    if named.is_empty() && settings.unit.is_some() {
        settings::warn("--unit", "it is the unit of --field, which is not given", &mut notes);
    }
    let plans: BTreeMap<&str, Plan> =
        topics.iter().filter_map(|(name, topic)| Some((name.as_str(), plan(name, topic, &named, unit)?))).collect();
    let mut collected = Collected::default();
    messages_of(file, bytes, |message| {
        if let Some(plan) = plans.get(message.topic) {
            collected.take(&message, plan);
        }
    })?;
    if collected.tracks.is_empty() {
        return Err(no_channel_error(file, topics, &named, &collected));
    }
    for (topic, count) in collected.unread.iter().filter(|(topic, _)| collected.tracks.contains_key(*topic)) {
        notes.push(MessagesLeftOut { topic: topic.clone(), count: *count });
    }
    if collected.by_log_time {
        notes.push(NoStamps {});
    }
    if !named.is_empty() && unit.is_none() {
        notes.push(UnitNotStated { file: None, unit: None, quantity: None });
    }
    messages::recording(file, &mut collected.tracks, settings, notes)
}

fn no_channel_error(
    file: &str,
    topics: &BTreeMap<String, Topic>,
    named: &[Field],
    collected: &Collected,
) -> IngestError {
    if let Some(field) = named.first() {
        if let Some(problem) = collected.decoders.values().find_map(|d| d.as_ref().err()) {
            let hint = "record it with its schema (a FileDescriptorSet), or export the acceleration as CSV";
            return messages::refuse(file, topics, &format!("protobuf messages cannot be decoded: {problem}"), hint);
        }
        let found = format!("no JSON or protobuf message has a number at {}", field.path);
        let numbers: Vec<String> =
            collected.decoders.values().flatten().flat_map(|(decoder, _)| decoder.paths()).collect();
        let hint = match numbers.as_slice() {
            [] => "correct --field, such as --field imu.acceleration.x".to_owned(),
            numbers => format!("correct --field; numbers there: {}", numbers.join(", ")),
        };
        return messages::refuse(file, topics, &found, &hint);
    }
    if let Some((topic, count)) = collected.unread.iter().next() {
        let found = format!("none of the {count} messages of {topic} holds linear acceleration");
        return messages::refuse(file, topics, &found, "export the channels as CSV");
    }
    let hint = if topics.values().any(|t| matches!(t.encoding.as_str(), "json" | "protobuf")) {
        "name the acceleration by --field, such as --field imu.acceleration.x, and its unit by --unit"
    } else if topics.values().any(|t| is_imu(&t.kind)) {
        "its encoding is not read (cdr, ros1, json and protobuf are): export the acceleration as CSV, or record it in \
         one of them"
    } else {
        "export the acceleration as CSV: time and acceleration columns with their units in the header"
    };
    messages::refuse(file, topics, "no topic with acceleration", hint)
}

/// The test and the waves of an artifact of any stage, as they are.
fn read_artifact(file: &str, bytes: &[u8]) -> Result<Recording> {
    let refuse = |found: &dyn std::fmt::Display| {
        IngestError::content(file, found, "an artifact as docs/format.md describes it", "check it as an artifact")
    };
    let artifact = Artifact::read(Path::new(file), bytes).map_err(|error| refuse(&error))?;
    let test: TestV1 =
        artifact.record("/test").map_err(|error| refuse(&error))?.ok_or_else(|| refuse(&"no record under /test"))?;
    let test = TestDescription::try_from(test).map_err(|error| refuse(&error))?;
    let mut notes = Notes::new();
    notes.push(FromArtifact { stage: artifact.stage().map(str::to_owned) });
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
        facts,
        ..Details::default()
    };
    let read = |channel: Channel| {
        let wave = artifact.waves().get(&channel.id).filter(|w| w.quantity == channel.quantity);
        let is_pulse = test.pulse.as_deref() == Some(channel.id.as_str());
        let fitness = Fitness::of_only(channel.quantity, "the pulse of the artifact");
        let fitness = fitness.filter(|_| is_pulse || test.pulse.is_none());
        ReadChannel { wave: wave.map(|w| w.sampled.clone()), fitness, ..ReadChannel::new(channel) }
    };
    let mut channels: Vec<ReadChannel> = test.channels.iter().cloned().map(read).collect();
    for (id, wave) in artifact.waves() {
        if !test.channels.iter().any(|c| c.id == *id && c.quantity == wave.quantity) {
            // A wave that the test does not list, or lists as something else, such as a displacement of the pulse.
            let taken = channels.iter().any(|f| f.channel.id == *id);
            let name = if taken { format!("{id}-{}", wave.quantity) } else { id.clone() };
            let mut extra = read(Channel::new(name, wave.quantity));
            extra.wave = Some(wave.sampled.clone());
            channels.push(extra);
        }
    }
    let pulse_rule = if test.pulse.is_some() { PulseRule::Fittest } else { PulseRule::OnlyOne };
    Ok(Recording { details, channels, pulse_rule, contact_at_zero: test.contact.is_some(), notes })
}

remarks! {
    /// Remarks of MCAP files.
    pub REMARKS;

    /// Messages of a topic do not hold the fields that are read.
    CR038 MessagesLeftOut { topic: String, count: u64 }
    bears on (About::Record, Weight::Slight)
    decided "Every field of --field must be a number in a message, and the message must decode."
    means "Samples are missing where these messages were. Uneven times that this leaves are refused."
    remedy "check --field against the messages, or record them whole"
    says format!("topic {topic}: {count} messages do not hold the fields and are left out");

    /// Messages have no stamp of their own, so that the time of recording is taken.
    CR039 NoStamps {}
    bears on (About::Record, Weight::Slight)
    decided "A message of JSON or protobuf has no field with a time stamp that is known."
    means "Messages are recorded later than they are measured, and by delays that vary: times are less certain."
    remedy "write a stamp of the sensor into each message"
    says "messages without a stamp of their own: the time of recording is taken for the time of measurement";

    /// The input is an artifact of a stage, not a record of a test.
    CR040 FromArtifact { stage: Option<String> }
    bears on (About::Record, Weight::None)
    decided "The file has the topic /test of an artifact (docs/format.md)."
    means "Nothing of that stage is undone: what it filtered stays filtered."
    remedy "nothing; give the record itself to begin anew"
    says {
        let stage = stage.as_deref().unwrap_or("a stage that does not say its name");
        format!("read from an artifact of {stage}: channels and samples are as that stage left them")
    };
}

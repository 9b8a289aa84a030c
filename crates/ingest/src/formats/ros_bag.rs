//! ROS 1 bags, version 2.0; chunks plain, or packed by bz2 or lz4.
//!
//! After the line `#ROSBAG V2.0`, records: header length, header fields `name=value`, data length, data. A chunk's data
//! are records; a connection names topic and type of the messages that carry its number.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Read;

use crumple_signal::Notes;

use crate::formats::messages::{self, Topic, Track, imu_components, is_imu};
use crate::formats::reader::{Bundle, Reader, check_total};
use crate::recording::content::Recording;
use crate::{IngestSettings, Result, check_size};

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";
const MESSAGE: u8 = 2;
const CHUNK: u8 = 5;
const CONNECTION: u8 = 7;
/// Largest chunk that is unpacked, bytes. `rosbag record` makes them of 768 KiB.
const CHUNK_LIMIT: u64 = 1 << 28;

pub const ROS_BAG: Reader =
    Reader::of_one_file("ros1-bag", |head| head.starts_with(b"#ROSBAG V"), &["--resample"], read);

fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording> {
    let (file, bytes) = (bundle.main.name.as_str(), bundle.main.bytes.as_slice());
    let Some(body) = bytes.strip_prefix(MAGIC) else {
        let hint = "rewrite it: rosbag migrate, or rosbag record";
        return refuse(file, At::file(0), "a bag of another version than 2.0", hint);
    };
    let mut bag = Bag::default();
    bag.records(file, body, At::file(MAGIC.len()))?;
    let mut topics: BTreeMap<String, Topic> = bag
        .connections
        .values()
        .map(|c| (c.topic.clone(), Topic { kind: c.kind.clone(), encoding: "ros1".to_owned(), count: 0 }))
        .collect();
    for connection in bag.connections.values() {
        if let Some(topic) = topics.get_mut(&connection.topic) {
            topic.count += connection.messages;
        }
    }
    bag.tracks.retain(|_, track| !track.samples.is_empty());
    if bag.tracks.is_empty() {
        let hint = "export the acceleration as CSV: rostopic echo -b FILE -p TOPIC";
        return Err(messages::refuse(file, &topics, "no topic with acceleration", hint));
    }
    messages::recording(file, &mut bag.tracks, settings, Notes::new())
}

#[derive(Default)]
struct Connection {
    topic: String,
    kind: String,
    messages: u64,
}

#[derive(Default)]
struct Bag {
    connections: BTreeMap<u32, Connection>,
    tracks: BTreeMap<String, Track>,
    /// Bytes of all chunks so far, unpacked.
    unpacked: u64,
}

/// Where a record starts: a byte of the file, or of what the chunk at some byte of it was packed of.
#[derive(Debug, Clone, Copy)]
struct At {
    chunk: Option<usize>,
    byte: usize,
}

impl At {
    fn file(byte: usize) -> Self {
        Self { chunk: None, byte }
    }
}

fn refuse<T>(file: &str, At { chunk, byte }: At, found: impl std::fmt::Display, hint: &str) -> Result<T> {
    let place = chunk.map_or_else(String::new, |chunk| format!(" of the unpacked chunk at byte {chunk}"));
    let expected = "a ROS 1 bag, version 2.0, its chunks plain or packed by bz2 or lz4";
    crate::refuse(file, format!("{found} (byte {byte}{place})"), expected, hint)
}

/// The records of a chunk, by what its header says of their packing and their length.
fn unpack<'a>(file: &str, start: usize, header: &BTreeMap<&[u8], &[u8]>, data: &'a [u8]) -> Result<Cow<'a, [u8]>> {
    let compression = words(header, b"compression");
    let packed: Box<dyn Read + 'a> = match compression.as_str() {
        "none" | "" => return Ok(Cow::Borrowed(data)),
        "bz2" => Box::new(bzip2::read::BzDecoder::new(data)),
        "lz4" => Box::new(lz4_flex::frame::FrameDecoder::new(data)),
        other => {
            let found = format!("a chunk compressed by {other:?}");
            return refuse(file, At::file(start), found, "unpack it first: rosbag decompress FILE");
        }
    };
    let size = u64::from(number(header, b"size").unwrap_or(0));
    let found = format!("a chunk that claims # MiB when unpacked (byte {start})");
    check_size(file, size, CHUNK_LIMIT, &found, "chunks up to # MiB")?;
    // Nothing is reserved from a claim, and no more is unpacked than claimed.
    let mut bytes = Vec::new();
    let found = match packed.take(size + 1).read_to_end(&mut bytes) {
        Err(error) => format!("a chunk that {compression} cannot unpack: {error}"),
        Ok(_) if bytes.len() as u64 == size => return Ok(Cow::Owned(bytes)),
        Ok(_) => {
            let than = if bytes.len() as u64 > size { "more than".to_owned() } else { format!("{} of", bytes.len()) };
            format!("a chunk that unpacks to {than} the {size} bytes it claims")
        }
    };
    refuse(file, At::file(start), found, CUT)
}

const CUT: &str = "the file may be cut short or damaged: rosbag reindex, or copy it again";

/// A length and as many bytes.
fn block(bytes: &[u8], at: usize) -> Option<(&[u8], usize)> {
    let length = u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?) as usize;
    let end = (at + 4).checked_add(length)?;
    Some((bytes.get(at + 4..end)?, end))
}

fn fields(header: &[u8]) -> BTreeMap<&[u8], &[u8]> {
    let mut fields = BTreeMap::new();
    let mut at = 0;
    while let Some((field, next)) = block(header, at) {
        if let Some(equals) = field.iter().position(|b| *b == b'=') {
            fields.insert(&field[..equals], &field[equals + 1..]);
        }
        at = next;
    }
    fields
}

fn number(fields: &BTreeMap<&[u8], &[u8]>, name: &[u8]) -> Option<u32> {
    fields.get(name).and_then(|v| Some(u32::from_le_bytes((*v).try_into().ok()?)))
}

fn words(fields: &BTreeMap<&[u8], &[u8]>, name: &[u8]) -> String {
    fields.get(name).map_or_else(String::new, |v| String::from_utf8_lossy(v).into_owned())
}

impl Bag {
    /// Reads all records of the file or of a chunk, which starts at `base`.
    fn records(&mut self, file: &str, bytes: &[u8], base: At) -> Result<()> {
        let mut at = 0;
        while at < bytes.len() {
            let start = At { byte: base.byte + at, ..base };
            let parts = block(bytes, at).and_then(|(header, next)| Some((header, block(bytes, next)?)));
            let Some((header, (data, next))) = parts else {
                return refuse(file, start, "a record is cut short", CUT);
            };
            at = next;
            let fields = fields(header);
            match fields.get(&b"op"[..]).and_then(|op| op.first()) {
                Some(&CHUNK) => {
                    if start.chunk.is_some() {
                        return refuse(file, start, "a chunk inside a chunk", CUT);
                    }
                    let records = unpack(file, start.byte, &fields, data)?;
                    self.unpacked += records.len() as u64;
                    check_total(file, self.unpacked)?;
                    self.records(file, &records, At { chunk: Some(start.byte), byte: 0 })?;
                }
                Some(&CONNECTION) => self.connection(&fields, data),
                Some(&MESSAGE) => self.message(file, start, &fields, data)?,
                Some(_) => {}
                None => return refuse(file, start, "a record without its kind", CUT),
            }
        }
        Ok(())
    }

    fn connection(&mut self, header: &BTreeMap<&[u8], &[u8]>, data: &[u8]) {
        let Some(id) = number(header, b"conn") else { return };
        let about = fields(data);
        let connection = self.connections.entry(id).or_default();
        connection.topic = words(header, b"topic");
        connection.kind = words(&about, b"type");
    }

    fn message(&mut self, file: &str, start: At, header: &BTreeMap<&[u8], &[u8]>, data: &[u8]) -> Result<()> {
        let connection = number(header, b"conn").and_then(|id| self.connections.get_mut(&id));
        let Some(connection) = connection else {
            return refuse(file, start, "a message of a connection that is not described before it", CUT);
        };
        connection.messages += 1;
        // Seconds and nanoseconds, four bytes each.
        let time: u64 =
            header.get(&b"time"[..]).and_then(|v| Some(u64::from_le_bytes((*v).try_into().ok()?))).unwrap_or(0);
        let recorded_ns = (time & 0xFFFF_FFFF).cast_signed() * 1_000_000_000 + (time >> 32).cast_signed();
        if is_imu(&connection.kind)
            && let Some(sample) = messages::imu(data, false, recorded_ns)
        {
            let track = self
                .tracks
                .entry(connection.topic.clone())
                .or_insert_with(|| Track { components: imu_components(), samples: Vec::new() });
            track.samples.push(sample);
        }
        Ok(())
    }
}

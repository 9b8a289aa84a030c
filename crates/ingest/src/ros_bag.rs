//! ROS 1 bags, version 2.0, uncompressed.
//!
//! After the line `#ROSBAG V2.0`, records: header length, header fields `name=value`, data length, data. A chunk's data are
//! records; a connection names topic and type of the messages that carry its number.

use std::collections::BTreeMap;

use crumple_signal::Notes;

use crate::bundle::Bundle;
use crate::messages::{self, Topic, Track, imu_components, is_imu};
use crate::recognise::Reader;
use crate::recording::Recording;
use crate::{IngestError, Place, Settings};

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";
const MESSAGE: u8 = 2;
const CHUNK: u8 = 5;
const CONNECTION: u8 = 7;

/// Reader of ROS 1 bags.
pub struct RosBag;

impl Reader for RosBag {
    fn format(&self) -> &'static str {
        "ros1-bag"
    }

    fn recognises(&self, head: &[u8]) -> bool {
        head.starts_with(b"#ROSBAG V")
    }

    fn read(&self, bundle: &Bundle, settings: &Settings) -> Result<Recording, IngestError> {
        let (file, bytes) = (bundle.main.name.as_str(), bundle.main.bytes.as_slice());
        let Some(body) = bytes.strip_prefix(MAGIC) else {
            return Err(refuse(
                file,
                0,
                "a bag of another version than 2.0",
                "rewrite it: rosbag migrate, or rosbag record",
            ));
        };
        let mut bag = Bag::default();
        bag.records(file, body, MAGIC.len(), true)?;
        let topics: BTreeMap<String, Topic> = bag
            .connections
            .values()
            .map(|c| (c.topic.clone(), Topic { kind: c.kind.clone(), encoding: "ros1".to_owned(), count: 0 }))
            .collect();
        let mut topics = topics;
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
        messages::recording(file, &bag.tracks, settings, Notes::new())
    }
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
}

fn refuse(file: &str, offset: usize, found: impl Into<String>, hint: &str) -> IngestError {
    let found: String = found.into();
    IngestError::content(
        Place::file(file),
        format!("{found} (byte {offset})"),
        "an uncompressed ROS 1 bag, version 2.0",
        hint,
    )
}

/// A length and as many bytes.
fn block(bytes: &[u8], at: usize) -> Option<(&[u8], usize)> {
    let length = u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?) as usize;
    let end = (at + 4).checked_add(length)?;
    Some((bytes.get(at + 4..end)?, end))
}

/// The fields of a record header.
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
    /// Reads all records of the file (`outer`) or of a chunk. `base` is the offset of `bytes` in the file.
    fn records(&mut self, file: &str, bytes: &[u8], base: usize, outer: bool) -> Result<(), IngestError> {
        let cut = "the file may be cut short: rosbag reindex, or copy it again";
        let mut at = 0;
        while at < bytes.len() {
            let start = base + at;
            let (header, next) = block(bytes, at).ok_or_else(|| refuse(file, start, "a record is cut short", cut))?;
            let (data, next) = block(bytes, next).ok_or_else(|| refuse(file, start, "a record is cut short", cut))?;
            at = next;
            let fields = fields(header);
            match fields.get(&b"op"[..]).and_then(|op| op.first()) {
                Some(&CHUNK) if outer => {
                    let compression = words(&fields, b"compression");
                    if compression != "none" {
                        let found = format!("a chunk compressed by {compression:?}");
                        return Err(refuse(file, start, found, "unpack it first: rosbag decompress FILE"));
                    }
                    self.records(file, data, base + at - data.len(), false)?;
                }
                Some(&CONNECTION) => self.connection(&fields, data),
                Some(&MESSAGE) => self.message(file, start, &fields, data)?,
                Some(_) => {}
                None => return Err(refuse(file, start, "a record without its kind", cut)),
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

    fn message(
        &mut self,
        file: &str,
        start: usize,
        header: &BTreeMap<&[u8], &[u8]>,
        data: &[u8],
    ) -> Result<(), IngestError> {
        let hint = "the file may be damaged: rosbag reindex, or copy it again";
        let connection = number(header, b"conn").and_then(|id| self.connections.get_mut(&id));
        let Some(connection) = connection else {
            return Err(refuse(file, start, "a message of a connection that is not described before it", hint));
        };
        connection.messages += 1;
        if is_imu(&connection.kind)
            && let Some(sample) = messages::imu(data, false)
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

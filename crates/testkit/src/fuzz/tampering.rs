//! Artifacts that are sound as containers, with every checksum right, and lie inside.

use std::collections::BTreeMap;
use std::io::Cursor;

use crumple_artifact::records::{
    CandidateV1, EventsV1, IdentificationV1, MetricsV2, ModesV2, NotesV1, PredictionV1, RecommendationV1, SimulationV1,
    StateSpaceV1, TestV1, TransferFunctionV1,
};
use crumple_artifact::{Codec, Record};
use mcap::records::{MessageHeader, Metadata, Record as McapRecord};
use serde_json::Value;

use crate::random::uniform;

/// A message with all that its channel and schema say.
#[derive(Debug, Clone)]
struct Message {
    topic: String,
    schema: String,
    schema_data: Vec<u8>,
    encoding: String,
    metadata: BTreeMap<String, String>,
    header: MessageHeader,
    payload: Vec<u8>,
}

/// The artifact in `bytes` with one to three lies in its messages.
///
/// # Errors
/// Of the container, in words: the bytes are no MCAP file.
pub fn tamper(bytes: &[u8], dice: &mut Dice) -> Result<Vec<u8>, String> {
    let (mut messages, metadata) = read(bytes).map_err(|error| error.to_string())?;
    for _ in 0..=dice.below(3) {
        lie(&mut messages, dice);
    }
    // The digest of the content is left out, or left as it was: a lie of its own.
    let keep_digest = dice.below(8) == 0;
    let kept: Vec<&Metadata> = metadata.iter().filter(|m| m.name != "content" || keep_digest).collect();
    write(&messages, &kept, dice.below(4) == 0).map_err(|error| error.to_string())
}

fn read(bytes: &[u8]) -> Result<(Vec<Message>, Vec<Metadata>), mcap::McapError> {
    let (mut schemas, mut channels) = (BTreeMap::new(), BTreeMap::new());
    let (mut messages, mut metadata) = (Vec::new(), Vec::new());
    for record in mcap::read::ChunkFlattener::new(bytes)? {
        match record? {
            McapRecord::Schema { header, data } => drop(schemas.insert(header.id, (header.name, data.into_owned()))),
            McapRecord::Channel(channel) => drop(channels.insert(channel.id, channel)),
            McapRecord::Metadata(record) => metadata.push(record),
            McapRecord::Message { header, data } => {
                if let Some(channel) = channels.get(&header.channel_id)
                    && let Some((schema, schema_data)) = schemas.get(&channel.schema_id)
                {
                    messages.push(Message {
                        topic: channel.topic.clone(),
                        schema: schema.clone(),
                        schema_data: schema_data.clone(),
                        encoding: channel.message_encoding.clone(),
                        metadata: channel.metadata.clone(),
                        header,
                        payload: data.into_owned(),
                    });
                }
            }
            // The summary says it all again.
            McapRecord::DataEnd(_) => break,
            _ => {}
        }
    }
    Ok((messages, metadata))
}

fn write(messages: &[Message], metadata: &[&Metadata], packed: bool) -> Result<Vec<u8>, mcap::McapError> {
    let mut file = Cursor::new(Vec::new());
    let compression = packed.then_some(mcap::Compression::Zstd);
    let mut writer = mcap::WriteOptions::new().compression(compression).compression_threads(0).create(&mut file)?;
    for record in metadata {
        writer.write_metadata(record)?;
    }
    for message in messages {
        let schema = writer.add_schema(&message.schema, "jsonschema", &message.schema_data)?;
        let channel = writer.add_channel(schema, &message.topic, &message.encoding, &message.metadata)?;
        writer.write_to_known_channel(&MessageHeader { channel_id: channel, ..message.header }, &message.payload)?;
    }
    writer.finish()?;
    drop(writer);
    Ok(file.into_inner())
}

fn lie(messages: &mut Vec<Message>, dice: &mut Dice) {
    if messages.is_empty() {
        return;
    }
    let (at, other) = (dice.below(messages.len()), dice.below(messages.len()));
    match dice.below(10) {
        0 => {
            let topic = messages[other].topic.clone();
            messages[at].topic = topic;
        }
        1 => messages[at].schema = messages[other].schema.clone(),
        2 => {
            let copy = messages[at].clone();
            messages.push(copy);
        }
        3 => drop(messages.remove(at)),
        4 => messages[at].encoding = (*dice.one_of(&["json", "bincode", "cbor", ""])).to_owned(),
        5 => mutate(&mut messages[at].payload, dice),
        6 if messages[at].encoding == "bincode" => lie_in_a_wave(&mut messages[at].payload, dice),
        6 | 7 => lie_in_bincode(&mut messages[at], dice),
        _ => lie_in_json(&mut messages[at].payload, dice),
    }
}

/// The record in bincode, with a number or a length replaced.
fn lie_in_bincode(message: &mut Message, dice: &mut Dice) {
    let Some(mut bytes) = in_bincode(message) else { return lie_in_json(&mut message.payload, dice) };
    if bytes.len() >= 8 {
        let at = dice.below(bytes.len() - 7);
        bytes[at..at + 8].copy_from_slice(&dice.one_of(&LYING_LENGTHS).to_le_bytes());
    }
    message.payload = bytes;
    message.encoding = "bincode".to_owned();
}

fn in_bincode(message: &Message) -> Option<Vec<u8>> {
    fn of<R: Record>(json: &[u8]) -> Option<Vec<u8>> {
        R::decode(Codec::Json, json).and_then(|record| record.encode(Codec::Bincode)).ok()
    }
    match message.schema.as_str() {
        CandidateV1::SCHEMA => of::<CandidateV1>(&message.payload),
        EventsV1::SCHEMA => of::<EventsV1>(&message.payload),
        IdentificationV1::SCHEMA => of::<IdentificationV1>(&message.payload),
        MetricsV2::SCHEMA => of::<MetricsV2>(&message.payload),
        ModesV2::SCHEMA => of::<ModesV2>(&message.payload),
        NotesV1::SCHEMA => of::<NotesV1>(&message.payload),
        PredictionV1::SCHEMA => of::<PredictionV1>(&message.payload),
        RecommendationV1::SCHEMA => of::<RecommendationV1>(&message.payload),
        SimulationV1::SCHEMA => of::<SimulationV1>(&message.payload),
        StateSpaceV1::SCHEMA => of::<StateSpaceV1>(&message.payload),
        TestV1::SCHEMA => of::<TestV1>(&message.payload),
        TransferFunctionV1::SCHEMA => of::<TransferFunctionV1>(&message.payload),
        _ => None,
    }
}

/// Start, step, place or a sample of a block of samples.
fn lie_in_a_wave(payload: &mut [u8], dice: &mut Dice) {
    let numbers = [0.0, -1.0, 1e-300, 1e300, -1e300, f64::NAN, f64::INFINITY, 1e-12, 1e9, f64::from_bits(1)];
    let words = payload.len() / 8;
    let word = if dice.below(2) == 0 { dice.below(4) } else { dice.below(words) };
    if let Some(place) = payload.get_mut(8 * word..8 * word + 8) {
        let lie = if dice.below(2) == 0 { dice.one_of(&numbers).to_bits() } else { *dice.one_of(&LYING_LENGTHS) };
        place.copy_from_slice(&lie.to_le_bytes());
    }
}

/// One value in the record is another, or is gone.
fn lie_in_json(payload: &mut Vec<u8>, dice: &mut Dice) {
    let Ok(mut record) = serde_json::from_slice::<Value>(payload) else { return mutate(payload, dice) };
    let count = values_in(&record);
    let chosen = dice.below(count);
    let lie = match dice.below(12) {
        0 => Value::Null,
        1 => Value::from("x".repeat(1 << dice.below(16))),
        2 => Value::from("\u{1b}]0;title\u{7}\u{202e}"),
        3 => Value::Array(Vec::new()),
        4 => Value::Bool(true),
        5 => Value::from(u64::MAX),
        _ => Value::from(*dice.one_of(&[0.0, -1.0, 1e300, -1e300, 1e-320, 1e9, -1e-9, 1e18])),
    };
    replace(&mut record, &mut chosen.clone(), &lie);
    *payload = record.to_string().into_bytes();
}

fn values_in(value: &Value) -> usize {
    match value {
        Value::Array(items) => 1 + items.iter().map(values_in).sum::<usize>(),
        Value::Object(fields) => 1 + fields.values().map(values_in).sum::<usize>(),
        _ => 1,
    }
}

/// Replaces the value of that number in the order of [`values_in`].
fn replace(value: &mut Value, number: &mut usize, lie: &Value) {
    if *number == 0 {
        *value = lie.clone();
        *number = usize::MAX;
        return;
    }
    *number = number.saturating_sub(1);
    match value {
        Value::Array(items) => items.iter_mut().for_each(|item| step(item, number, lie)),
        Value::Object(fields) => fields.values_mut().for_each(|field| step(field, number, lie)),
        _ => {}
    }
}

fn step(value: &mut Value, number: &mut usize, lie: &Value) {
    // Beyond the one that was replaced the number has no meaning.
    if *number < usize::MAX / 2 {
        replace(value, number, lie);
    }
}

/// Numbers by the place of the file in its campaign, so that any file can be made again.
#[derive(Debug, Clone)]
pub struct Dice {
    place: u64,
}

impl Dice {
    /// The dice of file `number` of a campaign.
    pub fn new(number: u64) -> Self {
        Self { place: number << 20 }
    }

    /// A whole number below `limit`; 0 where there is none.
    pub fn below(&mut self, limit: usize) -> usize {
        self.place += 1;
        (((uniform(self.place) + 1.0) / 2.0 * limit as f64) as usize).min(limit.saturating_sub(1))
    }

    /// One of several.
    pub fn one_of<'a, T>(&mut self, choices: &'a [T]) -> &'a T {
        &choices[self.below(choices.len())]
    }
}

/// Lengths, counts and offsets that a reader must not believe.
const LYING_LENGTHS: [u64; 9] = [0, 1, 0xff, 1 << 16, 1 << 31, 1 << 32, 1 << 40, u64::MAX / 2, u64::MAX];

const PIECES: [&[u8]; 14] = [
    b"NaN",
    b"1e999",
    b"-1e308",
    b"99999999999999999999",
    b"\n",
    b",",
    b"\"",
    b"\0",
    b"\x1b[2J",
    b"\xff\xfe",
    b"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[",
    b"{\"a\":",
    b"=",
    b"0",
];

/// One to four changes: bits, lengths, pieces of text, cuts, parts left out or twice.
pub fn mutate(bytes: &mut Vec<u8>, dice: &mut Dice) {
    for _ in 0..=dice.below(4) {
        let span = if dice.below(2) == 0 { bytes.len().min(4096) } else { bytes.len() };
        let at = dice.below(span + 1).min(bytes.len());
        let end = (at + dice.below(400)).min(bytes.len());
        match dice.below(8) {
            0 | 1 => bytes[at..].iter_mut().take(1).for_each(|byte| *byte ^= 1 << dice.below(8)),
            2 => {
                let length = dice.one_of(&LYING_LENGTHS).to_le_bytes();
                let end = bytes.len().min(at + 8);
                bytes[at..end].copy_from_slice(&length[..end - at]);
            }
            3 => drop(bytes.splice(at..at, dice.one_of(&PIECES).iter().copied())),
            4 => {
                let piece = *dice.one_of(&PIECES);
                let end = bytes.len().min(at + piece.len());
                bytes.splice(at..end, piece.iter().copied());
            }
            5 => drop(bytes.drain(at..end)),
            6 => {
                let copy = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, copy));
            }
            _ if dice.below(4) == 0 => bytes.truncate(at),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_can_be_replaced_and_one_at_a_time() {
        let record = serde_json::json!({"a": [1, 2], "b": {"c": 3}});
        let lie = Value::from("lie");
        let lies: Vec<String> = (1..values_in(&record))
            .map(|number| {
                let mut changed = record.clone();
                replace(&mut changed, &mut number.clone(), &lie);
                changed.to_string()
            })
            .collect();
        assert_eq!(
            lies,
            [
                r#"{"a":"lie","b":{"c":3}}"#,
                r#"{"a":["lie",2],"b":{"c":3}}"#,
                r#"{"a":[1,"lie"],"b":{"c":3}}"#,
                r#"{"a":[1,2],"b":"lie"}"#,
                r#"{"a":[1,2],"b":{"c":"lie"}}"#,
            ]
        );
    }
}

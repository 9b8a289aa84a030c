//! A recording for viewers: MCAP with a protobuf message a sample.

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::McapError;
use mcap::records::{MessageHeader, Metadata};

/// What a field of a message holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum FieldKind {
    /// A number.
    Double,
    /// A text.
    Text,
}

/// One value of a message; every field may lack some.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    /// A number.
    Double(f64),
    /// A text.
    Text(String),
}

/// Messages of one kind.
#[derive(Debug, Clone)]
pub(crate) struct Topic {
    /// Its name.
    pub(crate) name: String,
    /// Names of the fields and what they hold.
    pub(crate) fields: Vec<(String, FieldKind)>,
    /// What viewers show beside it.
    pub(crate) metadata: BTreeMap<String, String>,
    /// Log times, ns, rising, each with a value for each field.
    pub(crate) messages: Vec<(u64, Vec<Option<Value>>)>,
}

impl Topic {
    /// Of every so many messages those in which a field is lowest or highest.
    pub(crate) fn thinned(&self, every: usize) -> Self {
        let mut messages = Vec::new();
        for chunk in self.messages.chunks(every) {
            let mut is_kept = vec![false; chunk.len()];
            for field in 0..self.fields.len() {
                let number = |(k, (_, values)): (usize, &(u64, Vec<Option<Value>>))| match values[field] {
                    Some(Value::Double(value)) => Some((k, value)),
                    _ => None,
                };
                let numbers = || chunk.iter().enumerate().filter_map(number);
                let lowest = numbers().min_by(|a, b| a.1.total_cmp(&b.1));
                let highest = numbers().min_by(|a, b| b.1.total_cmp(&a.1));
                lowest.into_iter().chain(highest).for_each(|(k, _)| is_kept[k] = true);
            }
            messages.extend(chunk.iter().zip(is_kept).filter(|(_, kept)| *kept).map(|(message, _)| message.clone()));
        }
        let mut thinned = Self { messages, ..self.clone() };
        thinned.metadata.insert("thinned".to_owned(), format!("lowest and highest of every {every} samples"));
        thinned
    }
}

/// Package of the message types.
const PACKAGE: &str = "crumple.view";
/// Bytes of a chunk.
const CHUNK: u64 = 1 << 20;

/// The file: messages in the order of their times, those of one time in the order of the topics. The same topics give
/// the same bytes.
pub(crate) fn recording(topics: &[Topic], library: &str) -> Result<Vec<u8>, McapError> {
    let options = mcap::WriteOptions::new().compression(None).profile("").library(library).chunk_size(Some(CHUNK));
    #[cfg(unix)]
    let options = options.compression(Some(mcap::Compression::Zstd)).compression_threads(0);
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = options.create(&mut bytes)?;
    let mut types: Vec<&[(String, FieldKind)]> = Vec::new();
    let mut order = Vec::new();
    for (number, topic) in topics.iter().enumerate() {
        let known = types.iter().position(|fields| *fields == topic.fields);
        let kind = known.unwrap_or_else(|| {
            types.push(&topic.fields);
            types.len() - 1
        });
        let name = format!("Motion{}", kind + 1);
        let schema = writer.add_schema(&format!("{PACKAGE}.{name}"), "protobuf", &descriptor(&name, &topic.fields))?;
        let channel = writer.add_channel(schema, &topic.name, "protobuf", &topic.metadata)?;
        order.extend(topic.messages.iter().enumerate().map(|(k, (time, _))| (*time, number, k, channel)));
    }
    order.sort_unstable();
    for (time, topic, k, channel_id) in order {
        let header = MessageHeader { channel_id, sequence: k as u32, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, &encoded(&topics[topic].messages[k].1))?;
    }
    writer.write_metadata(&Metadata { name: PACKAGE.to_owned(), metadata: BTreeMap::new() })?;
    writer.finish()?;
    drop(writer);
    Ok(bytes.into_inner())
}

// Protobuf by hand: https://protobuf.dev/programming-guides/encoding, and descriptor.proto for the description of a
// message type.

const VARINT: u64 = 0;
const FIXED: u64 = 1;
const BYTES: u64 = 2;

fn varint(mut value: u64, out: &mut Vec<u8>) {
    while value >= 0x80 {
        out.push((value as u8) | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

fn number(field: u64, value: u64, out: &mut Vec<u8>) {
    varint(field << 3 | VARINT, out);
    varint(value, out);
}

fn bytes(field: u64, value: &[u8], out: &mut Vec<u8>) {
    varint(field << 3 | BYTES, out);
    varint(value.len() as u64, out);
    out.extend_from_slice(value);
}

/// A message; a value that is absent is absent.
fn encoded(values: &[Option<Value>]) -> Vec<u8> {
    let mut out = Vec::new();
    for (field, value) in (1..).zip(values) {
        match value {
            None => {}
            Some(Value::Double(value)) => {
                varint(field << 3 | FIXED, &mut out);
                out.extend_from_slice(&value.to_le_bytes());
            }
            Some(Value::Text(text)) => bytes(field, text.as_bytes(), &mut out),
        }
    }
    out
}

/// `FileDescriptorSet` of one file with one message of proto3, whose fields are all optional.
fn descriptor(name: &str, fields: &[(String, FieldKind)]) -> Vec<u8> {
    let mut message = Vec::new();
    bytes(1, name.as_bytes(), &mut message);
    for (index, (field, kind)) in (0..).zip(fields) {
        let mut description = Vec::new();
        bytes(1, field.as_bytes(), &mut description);
        number(3, index + 1, &mut description);
        // LABEL_OPTIONAL; TYPE_DOUBLE or TYPE_STRING; the oneof that stands for an optional field.
        number(4, 1, &mut description);
        number(5, if *kind == FieldKind::Double { 1 } else { 9 }, &mut description);
        number(9, index, &mut description);
        number(17, 1, &mut description);
        bytes(2, &description, &mut message);
    }
    for (field, _) in fields {
        let mut oneof = Vec::new();
        bytes(1, format!("_{field}").as_bytes(), &mut oneof);
        bytes(8, &oneof, &mut message);
    }
    let mut file = Vec::new();
    bytes(1, format!("crumple/view/{name}.proto").as_bytes(), &mut file);
    bytes(2, PACKAGE.as_bytes(), &mut file);
    bytes(4, &message, &mut file);
    bytes(12, b"proto3", &mut file);
    let mut set = Vec::new();
    bytes(1, &file, &mut set);
    set
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_read_back_by_its_numbers_and_absent_is_absent() {
        let values = [Some(Value::Double(0.1)), None, Some(Value::Text("ab".to_owned()))];
        let bytes = [&[9][..], &0.1_f64.to_le_bytes(), &[26, 2, b'a', b'b']].concat();
        assert_eq!(encoded(&values), bytes);
        let sixteenth = vec![None; 15].into_iter().chain([Some(Value::Double(1.0))]).collect::<Vec<_>>();
        assert_eq!(encoded(&sixteenth)[..2], [0x81, 0x01]);
    }

    #[test]
    fn a_peak_stays_and_the_file_is_in_order_of_time() {
        let message = |k: u32| {
            let value = f64::from(k % 7) + if k == 333 { 100.0 } else { 0.0 };
            (u64::from(k) * 10, vec![Some(Value::Double(value))])
        };
        let topic = Topic {
            name: "/test/a".to_owned(),
            fields: vec![("displacement_m".to_owned(), FieldKind::Double)],
            metadata: BTreeMap::new(),
            messages: (0..1000).map(message).collect(),
        };
        let thinned = topic.thinned(50);
        assert!(thinned.messages.len() <= 40 && thinned.messages.contains(&topic.messages[333]));
        let other = Topic { name: "/test/b".to_owned(), ..topic.clone() };
        let bytes = recording(&[topic, other], "crumple test").unwrap();
        let times: Vec<u64> = mcap::MessageStream::new(&bytes).unwrap().map(|m| m.unwrap().log_time).collect();
        assert!(times.len() == 2000 && times.is_sorted());
    }
}

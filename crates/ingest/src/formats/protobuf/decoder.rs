//! Numbers out of protobuf messages, by the description of their type that an MCAP file carries.
//!
//! The schema of such a topic is a `FileDescriptorSet` (descriptor.proto), its name that of the message type. Read here
//! and not by a library: what decodes any message by its description (`prost-reflect` 0.16) panics on damaged
//! descriptions, and a path of numbers needs little of it. The tests write their messages with that library.

use std::borrow::Cow;
use std::collections::BTreeSet;

use crate::formats::protobuf::types::{Kind, NumberType, Types};
use crate::formats::protobuf::wire::{self, WireReader, WireValue};

/// Fields of fields that are looked into for a list of numbers.
const DEPTH: usize = 4;
/// Most numbers listed.
const LISTED: usize = 20;
/// Most fields looked at for that list: types that hold each other have paths without end and may have no number.
const LOOKED_AT: usize = 2_000;
/// Names of the stamp, the first that is there counts: Foxglove's types, those of ROS, plain ones.
const STAMPS: [&str; 3] = ["timestamp", "header.stamp", "stamp"];
const SECONDS: [&str; 3] = ["seconds", "sec", "secs"];
const NANOSECONDS: [&str; 4] = ["nanos", "nsec", "nanosec", "nsecs"];

/// A number in messages of a type: the way to it through the fields.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Path {
    steps: Vec<Step>,
    number: NumberType,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Step {
    /// Number of the field.
    field: u32,
    /// Which of a repeated field.
    index: Option<usize>,
    /// A field that was not sent is not there; else it is 0.
    presence: bool,
}

/// Reads messages of one type.
#[derive(Debug, Clone)]
pub struct Decoder {
    types: Types,
    name: String,
    stamp: Option<[Path; 2]>,
}

impl Decoder {
    /// From the name and the data of the schema. Error: what is wrong with them, in words.
    pub fn new(name: &str, description: &[u8]) -> Result<Self, String> {
        let types = Types::read(description)
            .ok_or_else(|| "its schema is no description of protobuf types (FileDescriptorSet)".to_owned())?;
        if types.fields(name).is_none() {
            return Err(format!("its schema does not describe {name}"));
        }
        let mut decoder = Self { types, name: name.to_owned(), stamp: None };
        let part = |stamp: &str, names: &[&str]| names.iter().find_map(|n| decoder.path(&format!("{stamp}.{n}")));
        let stamp = STAMPS.iter().find_map(|stamp| Some([part(stamp, &SECONDS)?, part(stamp, &NANOSECONDS)?]));
        decoder.stamp = stamp.filter(|parts| parts.iter().all(|p| p.number.is_whole()));
        Ok(decoder)
    }

    /// The way to `linear_acceleration.x` or `samples.0`; `None` if the type has no number there.
    pub fn path(&self, text: &str) -> Option<Path> {
        let mut steps = Vec::new();
        let mut kind = Kind::Message(self.name.clone());
        let mut parts = text.split('.');
        while let Some(part) = parts.next() {
            let Kind::Message(name) = &kind else { return None };
            let field = self.types.fields(name)?.iter().find(|f| f.name == part)?;
            let index = if field.repeated { Some(parts.next()?.parse().ok()?) } else { None };
            steps.push(Step { field: field.number, index, presence: field.presence });
            kind = field.kind.clone();
        }
        if let Kind::Number(number) = kind { Some(Path { steps, number }) } else { None }
    }

    /// Paths of numbers in the type, for messages: `acceleration.x`.
    pub fn paths(&self) -> Vec<String> {
        let (mut paths, mut looked_at) = (BTreeSet::new(), 0);
        self.list(&self.name, "", DEPTH, &mut looked_at, &mut paths);
        paths.into_iter().take(LISTED).collect()
    }

    fn list(&self, name: &str, before: &str, depth: usize, looked_at: &mut usize, paths: &mut BTreeSet<String>) {
        for field in self.types.fields(name).unwrap_or_default() {
            if paths.len() >= LISTED || *looked_at >= LOOKED_AT {
                return;
            }
            *looked_at += 1;
            let path = format!("{before}{}{}", field.name, if field.repeated { ".0" } else { "" });
            match &field.kind {
                Kind::Number(_) => drop(paths.insert(path)),
                Kind::Message(inner) if depth > 1 && !STAMPS.contains(&path.as_str()) => {
                    self.list(inner, &format!("{path}."), depth - 1, looked_at, paths);
                }
                Kind::Message(_) | Kind::Other => {}
            }
        }
    }

    /// The message's own stamp in ns: `google.protobuf.Timestamp`, or ROS time, under one of the usual names.
    pub fn stamp_ns(&self, message: &[u8]) -> Option<i64> {
        let [seconds, nanoseconds] = self.stamp.as_ref()?;
        let whole = |path: &Path| match read(message, path)? {
            Value::Whole(x) => i64::try_from(x).ok(),
            Value::Real(_) => None,
        };
        whole(seconds)?.checked_mul(1_000_000_000)?.checked_add(whole(nanoseconds)?)
    }
}

/// The number at a path. A plain number that was not sent is 0, as protobuf has it; a message or an `optional` number
/// that was not sent is not there.
pub fn number(message: &[u8], path: &Path) -> Option<f64> {
    Some(match read(message, path)? {
        Value::Whole(x) => x as f64,
        Value::Real(x) => x,
    })
}

/// A number as it was sent.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Value {
    Whole(i128),
    Real(f64),
}

fn read(message: &[u8], path: &Path) -> Option<Value> {
    let (last, inner) = path.steps.split_last()?;
    let mut message = Cow::Borrowed(message);
    for step in inner {
        message = match message {
            Cow::Borrowed(bytes) => inner_message(bytes, step)?,
            Cow::Owned(bytes) => Cow::Owned(inner_message(&bytes, step)?.into_owned()),
        };
    }
    let (mut value, mut count) = (None, 0);
    wire::for_each_field(&message, |field, raw| {
        if field == last.field {
            values(raw, path.number, |next| {
                if last.index.is_none_or(|index| index == count) {
                    value = Some(next);
                }
                count += 1;
            })?;
        }
        Some(())
    })?;
    let zero = if path.number.is_whole() { Value::Whole(0) } else { Value::Real(0.0) };
    value.or((last.index.is_none() && !last.presence).then_some(zero))
}

/// A message in a message. What was sent in several parts counts as one.
fn inner_message<'a>(message: &'a [u8], step: &Step) -> Option<Cow<'a, [u8]>> {
    let mut parts: Vec<&[u8]> = Vec::new();
    wire::for_each_field(message, |field, raw| {
        if field == step.field {
            parts.push(raw.bytes()?);
        }
        Some(())
    })?;
    match (step.index, parts.as_slice()) {
        (Some(index), parts) => parts.get(index).map(|part| Cow::Borrowed(*part)),
        (None, []) => None,
        (None, [one]) => Some(Cow::Borrowed(one)),
        (None, several) => Some(Cow::Owned(several.concat())),
    }
}

/// Tells `each` number of a field: one, or several in a row.
fn values(raw: WireValue, number: NumberType, mut each: impl FnMut(Value)) -> Option<()> {
    match (raw, number.size()) {
        (WireValue::Varint(bits), None) => each(number.value_of_varint(bits)),
        (WireValue::Eight(bytes), Some(8)) => each(number.value_of_bits(u64::from_le_bytes(bytes))),
        (WireValue::Four(bytes), Some(4)) => each(number.value_of_bits(u64::from(u32::from_le_bytes(bytes)))),
        (WireValue::Bytes(packed), size) => {
            let mut reader = WireReader(packed);
            while !reader.0.is_empty() {
                each(match size {
                    None => number.value_of_varint(reader.varint()?),
                    Some(8) => number.value_of_bits(u64::from_le_bytes(reader.take()?)),
                    Some(_) => number.value_of_bits(u64::from(u32::from_le_bytes(reader.take()?))),
                });
            }
        }
        _ => return None,
    }
    Some(())
}

impl NumberType {
    /// Bytes of a number of fixed length.
    fn size(self) -> Option<usize> {
        match self {
            Self::Double | Self::Fixed64 | Self::SFixed64 => Some(8),
            Self::Float | Self::Fixed32 | Self::SFixed32 => Some(4),
            Self::Int | Self::UInt | Self::SInt => None,
        }
    }

    fn is_whole(self) -> bool {
        !matches!(self, Self::Double | Self::Float)
    }

    fn value_of_varint(self, bits: u64) -> Value {
        Value::Whole(match self {
            Self::UInt => i128::from(bits),
            // 0, -1, 1, -2, ... as 0, 1, 2, 3, ...
            Self::SInt => i128::from((bits >> 1).cast_signed() ^ -((bits & 1).cast_signed())),
            _ => i128::from(bits.cast_signed()),
        })
    }

    fn value_of_bits(self, bits: u64) -> Value {
        match self {
            Self::Double => Value::Real(f64::from_bits(bits)),
            Self::Float => Value::Real(f64::from(f32::from_bits(bits as u32))),
            Self::SFixed32 => Value::Whole(i128::from((bits as u32).cast_signed())),
            Self::SFixed64 => Value::Whole(i128::from(bits.cast_signed())),
            _ => Value::Whole(i128::from(bits)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Field `number` of a message, with bytes in it.
    fn with_bytes(number: u8, bytes: &[u8]) -> Vec<u8> {
        let mut length = bytes.len();
        let mut field = vec![number << 3 | 2];
        while length > 0x7f {
            field.push(length as u8 | 0x80);
            length >>= 7;
        }
        field.push(length as u8);
        [field, bytes.to_vec()].concat()
    }

    /// A type `T` of many fields, each a `T` again: paths without end, and no number.
    #[test]
    fn the_list_of_numbers_looks_at_so_many_fields_and_no_more() {
        let field = |k: usize| {
            let name = with_bytes(1, format!("f{k}").as_bytes());
            let type_name = with_bytes(6, b".T");
            // number, label optional, type message
            with_bytes(2, &[name, vec![0x18, (k % 100) as u8 + 1, 0x20, 1, 0x28, 11], type_name].concat())
        };
        let fields: Vec<u8> = (0..250).flat_map(field).collect();
        let message = [with_bytes(1, b"T"), fields].concat();
        let decoder = Decoder::new("T", &with_bytes(1, &with_bytes(4, &message))).unwrap();
        let (mut paths, mut looked_at) = (BTreeSet::new(), 0);
        decoder.list("T", "", DEPTH, &mut looked_at, &mut paths);
        assert_eq!((looked_at, paths.len()), (LOOKED_AT, 0));
    }
}

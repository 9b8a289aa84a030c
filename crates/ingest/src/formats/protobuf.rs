//! The fields of a protobuf message as they stand in its bytes.
//!
//! Numbers out of protobuf messages, by the description of their type that an MCAP file carries.
//!
//! The schema of such a topic is a `FileDescriptorSet` (descriptor.proto), its name that of the message type. Read here
//! and not by a library: what decodes any message by its description (`prost-reflect` 0.16) panics on damaged
//! descriptions, and a path of numbers needs little of it. The tests write their messages with that library.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

pub type WireField<'a> = (u32, WireValue<'a>);

/// A value by its wire type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WireValue<'a> {
    /// Type 0.
    Varint(u64),
    /// Type 1.
    Eight([u8; 8]),
    /// Type 2: texts, messages, packed numbers.
    Bytes(&'a [u8]),
    /// Type 5.
    Four([u8; 4]),
}

impl<'a> WireValue<'a> {
    pub fn bytes(self) -> Option<&'a [u8]> {
        if let Self::Bytes(bytes) = self { Some(bytes) } else { None }
    }

    pub fn varint(self) -> Option<u64> {
        if let Self::Varint(bits) = self { Some(bits) } else { None }
    }
}

/// What is left of a message.
#[derive(Debug, Clone, Copy)]
pub struct WireReader<'a>(pub &'a [u8]);

impl<'a> WireReader<'a> {
    /// A number of up to 64 bits, seven to a byte, the lowest first.
    pub fn varint(&mut self) -> Option<u64> {
        let mut bits = 0;
        for k in 0..10 {
            let (byte, rest) = self.0.split_first()?;
            self.0 = rest;
            bits |= u64::from(byte & 0x7F) << (7 * k);
            if byte & 0x80 == 0 {
                return Some(bits);
            }
        }
        None
    }

    /// The next `N` bytes.
    pub fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (bytes, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*bytes)
    }

    /// The next field; `Some(None)` at the end, `None` where the bytes are no field. Groups, long out of use, are none.
    fn field(&mut self) -> Option<Option<WireField<'a>>> {
        if self.0.is_empty() {
            return Some(None);
        }
        let tag = self.varint()?;
        let number = u32::try_from(tag >> 3).ok().filter(|n| *n > 0)?;
        let raw = match tag & 7 {
            0 => WireValue::Varint(self.varint()?),
            1 => WireValue::Eight(self.take()?),
            2 => {
                let length = usize::try_from(self.varint()?).ok()?;
                let (bytes, rest) = self.0.split_at_checked(length)?;
                self.0 = rest;
                WireValue::Bytes(bytes)
            }
            5 => WireValue::Four(self.take()?),
            _ => return None,
        };
        Some(Some((number, raw)))
    }
}

/// Tells `each` field of a message in the order of its bytes. `None` if they are no message, or `each` says so.
fn for_each_field<'a>(message: &'a [u8], mut each: impl FnMut(u32, WireValue<'a>) -> Option<()>) -> Option<()> {
    let mut reader = WireReader(message);
    while let Some((number, raw)) = reader.field()? {
        each(number, raw)?;
    }
    Some(())
}

/// Types in types that are followed.
const NESTING: usize = 32;

/// Fields by the full name of their type.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Types(BTreeMap<String, Vec<Field>>);

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    pub name: String,
    pub number: u32,
    /// Whether there may be several.
    pub repeated: bool,
    /// Whether "not sent" differs from 0: `optional`, members of a `oneof`, all fields of proto2.
    pub presence: bool,
    pub kind: Kind,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Kind {
    Number(NumberType),
    Message(String),
    /// Text, bytes, a truth value, an enumeration.
    Other,
}

/// How a number is sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberType {
    /// `double`.
    Double,
    /// `float`.
    Float,
    /// `int32`, `int64`.
    Int,
    /// `uint32`, `uint64`.
    UInt,
    /// `sint32`, `sint64`.
    SInt,
    /// `fixed32`.
    Fixed32,
    /// `fixed64`.
    Fixed64,
    /// `sfixed32`.
    SFixed32,
    /// `sfixed64`.
    SFixed64,
}

impl Types {
    /// From the bytes of a `FileDescriptorSet`; `None` if they are none.
    pub fn read(set: &[u8]) -> Option<Self> {
        let mut types = Self::default();
        for_each_field(set, |number, raw| if number == 1 { types.file(raw.bytes()?) } else { Some(()) })?;
        Some(types)
    }

    pub fn fields(&self, name: &str) -> Option<&[Field]> {
        self.0.get(name).map(Vec::as_slice)
    }

    /// `FileDescriptorProto`: package = 2, message_type = 4, syntax = 12.
    fn file(&mut self, file: &[u8]) -> Option<()> {
        let (mut package, mut proto3, mut messages) = (String::new(), false, Vec::new());
        for_each_field(file, |number, raw| {
            match number {
                2 => package = text(raw.bytes()?)?,
                4 => messages.push(raw.bytes()?),
                12 => proto3 = raw.bytes()? == b"proto3",
                _ => {}
            }
            Some(())
        })?;
        messages.into_iter().try_for_each(|message| self.message(message, &package, proto3, NESTING))
    }

    /// `DescriptorProto`: name = 1, field = 2, nested_type = 3, options = 7 (map_entry = 7). The entries of a map have
    /// no order: their type is left out.
    fn message(&mut self, message: &[u8], scope: &str, proto3: bool, depth: usize) -> Option<()> {
        let (mut name, mut fields, mut nested, mut map) = (String::new(), Vec::new(), Vec::new(), false);
        for_each_field(message, |number, raw| {
            match number {
                1 => name = text(raw.bytes()?)?,
                2 => fields.push(field(raw.bytes()?, proto3)?),
                3 => nested.push(raw.bytes()?),
                7 => for_each_field(raw.bytes()?, |option, raw| {
                    map |= option == 7 && raw.varint() == Some(1);
                    Some(())
                })?,
                _ => {}
            }
            Some(())
        })?;
        let name = if scope.is_empty() { name } else { format!("{scope}.{name}") };
        let depth = depth.checked_sub(1)?;
        nested.into_iter().try_for_each(|inner| self.message(inner, &name, proto3, depth))?;
        if !map {
            self.0.insert(name, fields);
        }
        Some(())
    }
}

/// `FieldDescriptorProto`: name = 1, number = 3, label = 4 (3: repeated), type = 5, type_name = 6, oneof_index = 9.
fn field(bytes: &[u8], proto3: bool) -> Option<Field> {
    let (mut name, mut type_name) = (String::new(), String::new());
    let (mut number, mut label, mut kind, mut one_of) = (0, 0, 0, false);
    for_each_field(bytes, |at, raw| {
        match at {
            1 => name = text(raw.bytes()?)?,
            3 => number = u32::try_from(raw.varint()?).ok()?,
            4 => label = raw.varint()?,
            5 => kind = raw.varint()?,
            6 => type_name = text(raw.bytes()?)?,
            9 => one_of = true,
            _ => {}
        }
        Some(())
    })?;
    let kind = match kind {
        1 => Kind::Number(NumberType::Double),
        2 => Kind::Number(NumberType::Float),
        3 | 5 => Kind::Number(NumberType::Int),
        4 | 13 => Kind::Number(NumberType::UInt),
        6 => Kind::Number(NumberType::Fixed64),
        7 => Kind::Number(NumberType::Fixed32),
        15 => Kind::Number(NumberType::SFixed32),
        16 => Kind::Number(NumberType::SFixed64),
        17 | 18 => Kind::Number(NumberType::SInt),
        11 => Kind::Message(type_name.trim_start_matches('.').to_owned()),
        _ => Kind::Other,
    };
    Some(Field { name, number, repeated: label == 3, presence: !proto3 || one_of, kind })
}

fn text(bytes: &[u8]) -> Option<String> {
    std::str::from_utf8(bytes).ok().map(str::to_owned)
}

/// Fields of fields that are looked into for a list of numbers.
const DEPTH: usize = 4;
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
    for_each_field(&message, |field, raw| {
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
    for_each_field(message, |field, raw| {
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

    #[test]
    fn fields_come_as_the_encoding_guide_has_them() {
        // Field 1 = 150, field 2 = "testing": the two examples of the protobuf encoding guide.
        let bytes = [&[0x08, 0x96, 0x01, 0x12, 0x07][..], b"testing"].concat();
        let mut fields = Vec::new();
        for_each_field(&bytes, |number, raw| {
            fields.push((number, raw));
            Some(())
        })
        .unwrap();
        assert_eq!(fields, [(1, WireValue::Varint(150)), (2, WireValue::Bytes(b"testing"))]);
    }

    #[test]
    fn what_is_cut_short_or_too_long_is_no_message() {
        for bytes in [&[0x08][..], &[0x12, 0x07, b't'], &[0xFF; 11], &[0x00, 0x00], &[0x0B, 0x0C], &[0x09, 1, 2]] {
            assert_eq!(for_each_field(bytes, |_, _| Some(())), None, "{bytes:?}");
        }
    }

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

//! The message types of a `FileDescriptorSet`, as far as numbers in them need it.

use std::collections::BTreeMap;

use crate::formats::protobuf::wire;

/// Types in types that are followed.
const NESTING: usize = 32;

/// Fields by the full name of their type.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Types(BTreeMap<String, Vec<Field>>);

/// A field of a message type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// Its number in the bytes.
    pub number: u32,
    /// Whether there may be several.
    pub repeated: bool,
    /// Whether "not sent" differs from 0: `optional`, members of a `oneof`, all fields of proto2.
    pub presence: bool,
    /// What it holds.
    pub kind: Kind,
}

/// What a field holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Number(NumberType),
    /// A message of this type.
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
        wire::for_each_field(set, |number, raw| if number == 1 { types.file(raw.bytes()?) } else { Some(()) })?;
        Some(types)
    }

    /// The fields of a type.
    pub fn fields(&self, name: &str) -> Option<&[Field]> {
        self.0.get(name).map(Vec::as_slice)
    }

    /// `FileDescriptorProto`: package = 2, message_type = 4, syntax = 12.
    fn file(&mut self, file: &[u8]) -> Option<()> {
        let (mut package, mut proto3, mut messages) = (String::new(), false, Vec::new());
        wire::for_each_field(file, |number, raw| {
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
        wire::for_each_field(message, |number, raw| {
            match number {
                1 => name = text(raw.bytes()?)?,
                2 => fields.push(field(raw.bytes()?, proto3)?),
                3 => nested.push(raw.bytes()?),
                7 => wire::for_each_field(raw.bytes()?, |option, raw| {
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
    wire::for_each_field(bytes, |at, raw| {
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

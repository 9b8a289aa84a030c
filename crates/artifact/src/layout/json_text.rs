//! JSON text of records as it stands on disk: what is unknown is left out.
//!
//! The schemas say number, not "number or null", since viewers read no unions. A field of a struct that is unknown is
//! therefore absent; readers take absent and `null` alike. An entry of a map or a list stays `null`: there it has a
//! meaning, such as an interval without an end.

use serde::ser::{self, Error as _, Serialize};

type Error = serde_json::Error;

/// The record as JSON, its fields in the order of the type.
pub(crate) fn to_json<T: Serialize + ?Sized>(value: &T) -> Result<Vec<u8>, Error> {
    let mut text = Vec::new();
    value.serialize(Writer { text: &mut text })?;
    Ok(text)
}

struct Writer<'a> {
    text: &'a mut Vec<u8>,
}

/// A list, map or struct being written, and what closes it.
struct Open<'a> {
    text: &'a mut Vec<u8>,
    is_first: bool,
    end: &'static str,
}

impl<'a> Writer<'a> {
    fn scalar<T: Serialize>(self, value: T) -> Result<(), Error> {
        serde_json::to_writer(self.text, &value)
    }

    fn open(self, start: &str, end: &'static str) -> Open<'a> {
        self.text.extend_from_slice(start.as_bytes());
        Open { text: self.text, is_first: true, end }
    }

    /// `{"Variant":` ... `}`, as serde writes it.
    fn variant(self, name: &str, start: &str, end: &'static str) -> Result<Open<'a>, Error> {
        self.text.push(b'{');
        serde_json::to_writer(&mut *self.text, name)?;
        self.text.push(b':');
        Ok(self.open(start, end))
    }
}

impl Open<'_> {
    fn comma(&mut self) {
        if !std::mem::take(&mut self.is_first) {
            self.text.push(b',');
        }
    }

    fn element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Error> {
        self.comma();
        value.serialize(Writer { text: self.text })
    }

    fn field<T: Serialize + ?Sized>(&mut self, name: &str, value: &T) -> Result<(), Error> {
        let (length, is_first) = (self.text.len(), self.is_first);
        self.comma();
        serde_json::to_writer(&mut *self.text, name)?;
        self.text.push(b':');
        let start = self.text.len();
        value.serialize(Writer { text: self.text })?;
        if self.text[start..] == *b"null" {
            self.text.truncate(length);
            self.is_first = is_first;
        }
        Ok(())
    }

    fn close(self) {
        self.text.extend_from_slice(self.end.as_bytes());
    }
}

macro_rules! scalars {
    ($($name:ident($type:ty)),* $(,)?) => {
        $(fn $name(self, value: $type) -> Result<(), Error> { self.scalar(value) })*
    };
}

impl<'a> ser::Serializer for Writer<'a> {
    type Ok = ();
    type Error = Error;
    type SerializeSeq = Open<'a>;
    type SerializeTuple = Open<'a>;
    type SerializeTupleStruct = Open<'a>;
    type SerializeTupleVariant = Open<'a>;
    type SerializeMap = Open<'a>;
    type SerializeStruct = Open<'a>;
    type SerializeStructVariant = Open<'a>;

    scalars! {
        serialize_bool(bool), serialize_i8(i8), serialize_i16(i16), serialize_i32(i32), serialize_i64(i64),
        serialize_u8(u8), serialize_u16(u16), serialize_u32(u32), serialize_u64(u64), serialize_f32(f32),
        serialize_f64(f64), serialize_char(char), serialize_str(&str), serialize_bytes(&[u8]),
    }

    fn serialize_none(self) -> Result<(), Error> {
        self.scalar(())
    }

    fn serialize_unit(self) -> Result<(), Error> {
        self.scalar(())
    }

    fn serialize_unit_struct(self, _: &'static str) -> Result<(), Error> {
        self.scalar(())
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<(), Error> {
        value.serialize(self)
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, variant: &'static str) -> Result<(), Error> {
        self.scalar(variant)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Result<(), Error> {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        value: &T,
    ) -> Result<(), Error> {
        let mut open = self.open("{", "}");
        open.comma();
        serde_json::to_writer(&mut *open.text, variant)?;
        open.text.push(b':');
        value.serialize(Writer { text: open.text })?;
        open.close();
        Ok(())
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Open<'a>, Error> {
        Ok(self.open("[", "]"))
    }

    fn serialize_tuple(self, _: usize) -> Result<Open<'a>, Error> {
        Ok(self.open("[", "]"))
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Open<'a>, Error> {
        Ok(self.open("[", "]"))
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        _: usize,
    ) -> Result<Open<'a>, Error> {
        self.variant(variant, "[", "]}")
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Open<'a>, Error> {
        Ok(self.open("{", "}"))
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Open<'a>, Error> {
        Ok(self.open("{", "}"))
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        _: usize,
    ) -> Result<Open<'a>, Error> {
        self.variant(variant, "{", "}}")
    }
}

macro_rules! elements {
    ($($trait:ident $method:ident),* $(,)?) => {$(
        impl ser::$trait for Open<'_> {
            type Ok = ();
            type Error = Error;
            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Error> { self.element(value) }
            fn end(self) -> Result<(), Error> { self.close(); Ok(()) }
        }
    )*};
}

elements! {
    SerializeSeq serialize_element,
    SerializeTuple serialize_element,
    SerializeTupleStruct serialize_field,
    SerializeTupleVariant serialize_field,
}

macro_rules! fields {
    ($($trait:ident),* $(,)?) => {$(
        impl ser::$trait for Open<'_> {
            type Ok = ();
            type Error = Error;
            fn serialize_field<T: Serialize + ?Sized>(&mut self, key: &'static str, value: &T) -> Result<(), Error> {
                self.field(key, value)
            }
            fn end(self) -> Result<(), Error> { self.close(); Ok(()) }
        }
    )*};
}

fields! { SerializeStruct, SerializeStructVariant }

impl ser::SerializeMap for Open<'_> {
    type Ok = ();
    type Error = Error;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Result<(), Error> {
        let text = serde_json::to_value(key)?;
        let name = text.as_str().ok_or_else(|| Error::custom("a key of a map is no text"))?;
        self.comma();
        serde_json::to_writer(&mut *self.text, name)?;
        self.text.push(b':');
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Error> {
        value.serialize(Writer { text: self.text })
    }

    fn end(self) -> Result<(), Error> {
        self.close();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[derive(serde::Serialize)]
    enum Kind {
        Plain,
        Of(f64),
        Between { low: Option<f64>, high: f64 },
    }

    #[derive(serde::Serialize)]
    struct Record {
        unknown_first: Option<f64>,
        name: &'static str,
        unknown: Option<String>,
        list: Vec<Option<i32>>,
        map: BTreeMap<String, Option<f64>>,
        kinds: (Kind, Kind, Kind),
        unknown_last: Option<u8>,
    }

    #[test]
    fn unknown_fields_are_left_out_and_everything_else_is_as_serde_json_writes_it() {
        let record = Record {
            unknown_first: None,
            name: "a \"name\" \u{1b}",
            unknown: None,
            list: vec![Some(1), None],
            map: BTreeMap::from([("low".to_owned(), None), ("high".to_owned(), Some(1e300))]),
            kinds: (Kind::Plain, Kind::Of(-0.0), Kind::Between { low: None, high: 0.1 }),
            unknown_last: None,
        };
        let text = String::from_utf8(to_json(&record).unwrap()).unwrap();
        let whole = serde_json::to_string(&record).unwrap();
        let without =
            ["\"unknown_first\":null,", "\"unknown\":null,", "\"low\":null,\"high\":0.1", ",\"unknown_last\":null"];
        let expected = whole
            .replace(without[0], "")
            .replace(without[1], "")
            .replace(without[2], "\"high\":0.1")
            .replace(without[3], "");
        assert_eq!(text, expected);
        assert!(text.contains(r#""low":null"#), "an entry of a map stays: {text}");
        assert_eq!(to_json(&Option::<u8>::None).unwrap(), b"null");
    }
}

//! Finds the first number that is not finite, or too large, in a value, by walking it as a serialiser.
//!
//! serde_json writes NaN as `null`, which reads back as "unknown" or not at all; so it must be caught before.

use serde::ser::{self, Serialize};

/// Path and value of the first number of `value` that is not finite.
pub(crate) fn first_non_finite<T: Serialize + ?Sized>(value: &T) -> Option<(String, f64)> {
    first_beyond(value, f64::MAX)
}

/// Path and value of the first number of `value` that is not within plus and minus a limit.
pub(crate) fn first_beyond<T: Serialize + ?Sized>(value: &T, limit: f64) -> Option<(String, f64)> {
    let mut walk = Walk { path: Vec::new(), limit };
    match value.serialize(&mut walk) {
        Err(Stop::Found(path, value)) => Some((path, value)),
        Ok(()) | Err(Stop::Other) => None,
    }
}

/// What is needed where such a number stands.
pub(crate) fn needed(value: f64) -> &'static str {
    if value.is_finite() { "numbers of a crash stay below 1e15" } else { "a finite number is needed" }
}

struct Walk {
    path: Vec<Step>,
    limit: f64,
}

/// From a container to a value in it. Most walks find nothing, so that steps become text at the end.
enum Step {
    Element(usize),
    Field(&'static str),
    Key(String),
}

impl Walk {
    fn place(&self) -> String {
        let mut place = String::new();
        for step in &self.path {
            let point = if place.is_empty() { "" } else { "." };
            match step {
                Step::Element(index) => place.push_str(&format!("[{index}]")),
                Step::Field(name) => place.push_str(&format!("{point}{name}")),
                Step::Key(name) => place.push_str(&format!("{point}{name}")),
            }
        }
        place
    }
}

#[derive(Debug)]
enum Stop {
    Found(String, f64),
    /// The value does not serialise; the encoder will say so.
    Other,
}

impl std::fmt::Display for Stop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("stopped")
    }
}

impl std::error::Error for Stop {}

impl ser::Error for Stop {
    fn custom<T: std::fmt::Display>(_: T) -> Self {
        Self::Other
    }
}

/// A container being walked: the walk and the index of the next element.
struct Inside<'a> {
    walk: &'a mut Walk,
    index: usize,
    key: String,
}

impl Inside<'_> {
    fn visit<T: Serialize + ?Sized>(&mut self, step: Step, value: &T) -> Result<(), Stop> {
        self.walk.path.push(step);
        value.serialize(&mut *self.walk)?;
        self.walk.path.pop();
        Ok(())
    }

    fn element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Stop> {
        self.index += 1;
        self.visit(Step::Element(self.index - 1), value)
    }
}

macro_rules! nothing {
    ($($name:ident($($type:ty)?)),* $(,)?) => {
        $(fn $name(self $(, _: $type)?) -> Result<(), Stop> { Ok(()) })*
    };
}

impl<'a> ser::Serializer for &'a mut Walk {
    type Ok = ();
    type Error = Stop;
    type SerializeSeq = Inside<'a>;
    type SerializeTuple = Inside<'a>;
    type SerializeTupleStruct = Inside<'a>;
    type SerializeTupleVariant = Inside<'a>;
    type SerializeMap = Inside<'a>;
    type SerializeStruct = Inside<'a>;
    type SerializeStructVariant = Inside<'a>;

    nothing! {
        serialize_bool(bool), serialize_i8(i8), serialize_i16(i16), serialize_i32(i32), serialize_i64(i64),
        serialize_u8(u8), serialize_u16(u16), serialize_u32(u32), serialize_u64(u64), serialize_char(char),
        serialize_str(&str), serialize_bytes(&[u8]), serialize_none(), serialize_unit(),
        serialize_unit_struct(&'static str),
    }

    fn serialize_f32(self, value: f32) -> Result<(), Stop> {
        self.serialize_f64(f64::from(value))
    }

    fn serialize_f64(self, value: f64) -> Result<(), Stop> {
        if value.abs() <= self.limit { Ok(()) } else { Err(Stop::Found(self.place(), value)) }
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<(), Stop> {
        value.serialize(self)
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, _: &'static str) -> Result<(), Stop> {
        Ok(())
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Result<(), Stop> {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        value: &T,
    ) -> Result<(), Stop> {
        value.serialize(self)
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Inside<'a>, Stop> {
        Ok(Inside { walk: self, index: 0, key: String::new() })
    }

    fn serialize_tuple(self, _: usize) -> Result<Inside<'a>, Stop> {
        self.serialize_seq(None)
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Inside<'a>, Stop> {
        self.serialize_seq(None)
    }

    fn serialize_tuple_variant(self, _: &'static str, _: u32, _: &'static str, _: usize) -> Result<Inside<'a>, Stop> {
        self.serialize_seq(None)
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Inside<'a>, Stop> {
        self.serialize_seq(None)
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Inside<'a>, Stop> {
        self.serialize_seq(None)
    }

    fn serialize_struct_variant(self, _: &'static str, _: u32, _: &'static str, _: usize) -> Result<Inside<'a>, Stop> {
        self.serialize_seq(None)
    }
}

macro_rules! elements {
    ($($trait:ident $method:ident),* $(,)?) => {$(
        impl ser::$trait for Inside<'_> {
            type Ok = ();
            type Error = Stop;
            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Stop> { self.element(value) }
            fn end(self) -> Result<(), Stop> { Ok(()) }
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
        impl ser::$trait for Inside<'_> {
            type Ok = ();
            type Error = Stop;
            fn serialize_field<T: Serialize + ?Sized>(&mut self, key: &'static str, value: &T) -> Result<(), Stop> {
                self.visit(Step::Field(key), value)
            }
            fn end(self) -> Result<(), Stop> { Ok(()) }
        }
    )*};
}

fields! { SerializeStruct, SerializeStructVariant }

impl ser::SerializeMap for Inside<'_> {
    type Ok = ();
    type Error = Stop;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Result<(), Stop> {
        self.key = serde_json::to_value(key).ok().and_then(|k| k.as_str().map(str::to_owned)).unwrap_or_default();
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Stop> {
        let key = std::mem::take(&mut self.key);
        self.visit(Step::Key(key), value)
    }

    fn end(self) -> Result<(), Stop> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[derive(serde::Serialize)]
    struct Deep {
        rows: Vec<Vec<f64>>,
        named: BTreeMap<String, Option<f64>>,
    }

    #[test]
    fn names_the_place_of_a_nan() {
        let mut deep = Deep { rows: vec![vec![1.0], vec![2.0, 3.0]], named: BTreeMap::new() };
        assert!(first_non_finite(&deep).is_none());
        deep.named.insert("stiffness_n_per_m".into(), Some(f64::INFINITY));
        assert_eq!(first_non_finite(&deep), Some(("named.stiffness_n_per_m".into(), f64::INFINITY)));
        deep.rows[1][1] = f64::NAN;
        assert_eq!(first_non_finite(&deep).unwrap().0, "rows[1][1]");
    }

    #[derive(serde::Serialize)]
    struct Wrapped(f64);

    #[derive(serde::Serialize)]
    enum Kind {
        Of(f64),
        Two(f64, f64),
    }

    #[test]
    fn a_nan_is_found_inside_every_kind_of_value() {
        assert!(first_non_finite(&(f32::NAN, 1)).is_some_and(|(place, _)| place == "[0]"));
        assert!(first_non_finite(&vec![Wrapped(1.0), Wrapped(f64::NAN)]).is_some_and(|(place, _)| place == "[1]"));
        assert!(first_non_finite(&Kind::Of(f64::NAN)).is_some());
        assert!(first_non_finite(&Kind::Two(0.0, f64::NAN)).is_some_and(|(place, _)| place == "[1]"));
        assert!(first_non_finite(&(1.0_f32, Wrapped(1.0), Kind::Of(1.0))).is_none());
    }
}

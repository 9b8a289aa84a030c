//! JSON text of records as it stands on disk: what is unknown is left out.
//!
//! The schemas say number, not "number or null", since viewers read no unions. A field of a struct that is unknown is
//! therefore absent; readers take absent and `null` alike. An entry of a map or a list stays `null`: there it has a
//! meaning, such as an interval without an end. JSON values know no structs, so the record goes through values that do.

use serde::Serialize;
use serde_content::{Data, Value};

/// The record as JSON, its fields in the order of the type.
pub(crate) fn to_json<T: Serialize>(record: &T) -> Result<Vec<u8>, String> {
    let mut value =
        serde_content::Serializer::new().human_readable().serialize(record).map_err(|error| error.to_string())?;
    leave_out_unknown_fields(&mut value);
    serde_json::to_vec(&value).map_err(|error| error.to_string())
}

fn leave_out_unknown_fields(value: &mut Value) {
    match value {
        Value::Option(Some(inner)) => leave_out_unknown_fields(inner),
        Value::Seq(entries) | Value::Tuple(entries) => entries.iter_mut().for_each(leave_out_unknown_fields),
        Value::Map(entries) => entries.iter_mut().for_each(|(_, entry)| leave_out_unknown_fields(entry)),
        Value::Struct(fields) => in_data(&mut fields.data),
        Value::Enum(variant) => in_data(&mut variant.data),
        _ => {}
    }
}

fn in_data(data: &mut Data) {
    match data {
        Data::NewType { value } => leave_out_unknown_fields(value),
        Data::Tuple { values } => values.iter_mut().for_each(leave_out_unknown_fields),
        Data::Struct { fields } => {
            fields.retain(|(_, value)| !matches!(value, Value::Option(None)));
            fields.iter_mut().for_each(|(_, value)| leave_out_unknown_fields(value));
        }
        Data::Unit => {}
    }
}

/// JSON without the blanks and ends of lines between its words.
pub(crate) fn without_blanks(text: &str) -> Vec<u8> {
    let mut out = Vec::with_capacity(text.len());
    let (mut is_text, mut is_escaped) = (false, false);
    for byte in text.bytes() {
        if is_text || !byte.is_ascii_whitespace() {
            out.push(byte);
        }
        if byte == b'"' && !is_escaped {
            is_text = !is_text;
        }
        is_escaped = is_text && byte == b'\\' && !is_escaped;
    }
    out
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
    struct Inner {
        speed: Option<f64>,
        gear: u8,
    }

    #[derive(serde::Serialize)]
    struct Record {
        unknown_first: Option<f64>,
        name: &'static str,
        unknown: Option<String>,
        list: Vec<Option<i32>>,
        map: BTreeMap<String, Option<f64>>,
        kinds: (Kind, Kind, Kind),
        inner: Option<Inner>,
        inner_by_name: BTreeMap<String, Inner>,
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
            inner: Some(Inner { speed: None, gear: 1 }),
            inner_by_name: BTreeMap::from([("x".to_owned(), Inner { speed: None, gear: 2 })]),
            unknown_last: None,
        };
        let text = String::from_utf8(to_json(&record).unwrap()).unwrap();
        let whole = serde_json::to_string(&record).unwrap();
        let without = [
            "\"unknown_first\":null,",
            "\"unknown\":null,",
            "\"low\":null,\"high\":0.1",
            ",\"unknown_last\":null",
            "\"speed\":null,",
        ];
        let expected = whole
            .replace(without[0], "")
            .replace(without[1], "")
            .replace(without[2], "\"high\":0.1")
            .replace(without[3], "")
            .replace(without[4], "");
        assert_eq!(text, expected);
        assert!(text.contains(r#""low":null"#), "an entry of a map stays: {text}");
    }
}

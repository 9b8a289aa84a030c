//! Records as JSON text, known by the name of their schema alone, and patterns of topics.

use serde::Serialize;
use serde_json::Value;

use crate::layout::names::same_type;
use crate::layout::record::{Record, SCHEMAS, TypeVisitor, with_type};
use crate::{Artifact, ArtifactBuilder, RawRecord, ReadError, WriteError};

// Records known by name only: by their schema name, as met in a file or on a line of text.

/// How JSON is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JsonForm {
    /// On one line, as in NDJSON.
    Line,
    /// Indented.
    Pretty,
}

impl JsonForm {
    /// The JSON text of a value, its fields in the order of the type.
    pub fn text<T: Serialize + ?Sized>(self, value: &T) -> Result<String, String> {
        match self {
            Self::Line => serde_json::to_string(value),
            Self::Pretty => serde_json::to_string_pretty(value),
        }
        .map_err(|error| error.to_string())
    }
}

impl Artifact {
    /// A record as JSON text, whatever its encoding on disk, decoded as the type that its schema names.
    ///
    /// Fields that the type does not know are dropped, as every stage drops them. `None`: the schema is of another
    /// project. Errors: the message does not decode or holds a number that is not finite; a version of the type
    /// later than this program's.
    pub fn json_text(&self, raw: &RawRecord, form: JsonForm) -> Result<Option<String>, ReadError> {
        if let Some(text) = with_type(&raw.schema, ToJson { artifact: self, raw, form }) {
            return text.map(Some);
        }
        match SCHEMAS.iter().rfind(|known| same_type(known, &raw.schema)) {
            Some(known) => Err(ReadError::Newer {
                path: self.path().to_owned(),
                what: format!("the record type of topic {}", raw.topic),
                found: raw.schema.clone(),
                known: (*known).to_owned(),
            }),
            None => Ok(None),
        }
    }
}

/// JSON Schema of the record type of this name, as it stands in artifacts; `None` if it is not in [`SCHEMAS`].
pub fn schema_json(schema: &str) -> Option<&'static [u8]> {
    with_type(schema, SchemaJson)
}

/// The same made of the type: what `just schemas` writes to `docs/schemas/`.
#[cfg(feature = "schemas")]
pub fn schema_of_type(schema: &str) -> Option<Value> {
    with_type(schema, SchemaOfType)
}

struct SchemaJson;

impl TypeVisitor for SchemaJson {
    type Output = &'static [u8];

    fn visit<R: Record>(self) -> Self::Output {
        R::schema_json()
    }
}

#[cfg(feature = "schemas")]
struct SchemaOfType;

#[cfg(feature = "schemas")]
impl TypeVisitor for SchemaOfType {
    type Output = Value;

    fn visit<R: Record>(self) -> Self::Output {
        R::schema_of_type()
    }
}

struct ToJson<'a> {
    artifact: &'a Artifact,
    raw: &'a RawRecord,
    form: JsonForm,
}

impl TypeVisitor for ToJson<'_> {
    type Output = Result<String, ReadError>;

    fn visit<R: Record>(self) -> Self::Output {
        let record: R = self.artifact.decode(self.raw)?;
        self.form.text(&record).map_err(|problem| ReadError::Message {
            path: self.artifact.path().to_owned(),
            topic: self.raw.topic.clone(),
            problem,
        })
    }
}

/// Adds a record given as JSON to an artifact, checked against the type that the schema names.
///
/// Errors: the schema is not one of [`SCHEMAS`]; the value does not decode; and those of [`ArtifactBuilder::put`].
pub fn put_json(builder: &mut ArtifactBuilder, topic: &str, schema: &str, data: Value) -> Result<(), WriteError> {
    let unknown = || WriteError::Encode {
        topic: topic.to_owned(),
        problem: format!("schema {schema:?} is unknown, expected one of {}", SCHEMAS.join(", ")),
    };
    with_type(schema, FromJson { builder, topic, data }).ok_or_else(unknown)?
}

struct FromJson<'a> {
    builder: &'a mut ArtifactBuilder,
    topic: &'a str,
    data: Value,
}

impl TypeVisitor for FromJson<'_> {
    type Output = Result<(), WriteError>;

    fn visit<R: Record>(self) -> Self::Output {
        let record: R = serde_json::from_value(self.data).map_err(|error| WriteError::Encode {
            topic: self.topic.to_owned(),
            problem: format!("not a {}: {error}", R::SCHEMA),
        })?;
        self.builder.put(self.topic, &record)
    }
}

// Patterns of topics.

/// Whether a topic matches a pattern: `*` stands for any text, also across `/`; `?` for one character.
pub fn topic_matches(pattern: &str, topic: &str) -> bool {
    let (pattern, topic): (Vec<char>, Vec<char>) = (pattern.chars().collect(), topic.chars().collect());
    let (mut p, mut t) = (0, 0);
    // Where to go on when the text taken by the last star was too short.
    let mut star = None;
    while t < topic.len() {
        if pattern.get(p) == Some(&'*') {
            star = Some((p, t));
            p += 1;
        } else if pattern.get(p).is_some_and(|c| *c == '?' || *c == topic[t]) {
            p += 1;
            t += 1;
        } else if let Some((at, taken)) = star {
            star = Some((at, taken + 1));
            p = at + 1;
            t = taken + 1;
        } else {
            return false;
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}

/// Whether some text matches both patterns.
pub(crate) fn patterns_meet(a: &str, b: &str) -> bool {
    let [a, b] = [a, b].map(|pattern| pattern.chars().collect::<Vec<char>>());
    // Whether what is left of both from here on can be one text.
    let mut meets = vec![vec![false; b.len() + 1]; a.len() + 1];
    for i in (0..=a.len()).rev() {
        for j in (0..=b.len()).rev() {
            let after = |i: usize, j: usize| meets.get(i).and_then(|row| row.get(j)).copied().unwrap_or(false);
            meets[i][j] = match (a.get(i), b.get(j)) {
                (None, None) => true,
                (Some('*'), _) | (_, Some('*')) => {
                    let (star_a, star_b) = (a.get(i) == Some(&'*'), b.get(j) == Some(&'*'));
                    (star_a && after(i + 1, j))
                        || (star_b && after(i, j + 1))
                        || (star_a && j < b.len() && after(i, j + 1))
                        || (star_b && i < a.len() && after(i + 1, j))
                }
                (Some(x), Some(y)) => (x == y || *x == '?' || *y == '?') && after(i + 1, j + 1),
                _ => false,
            };
        }
    }
    meets[0][0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Compression, Provenance};
    use std::io::Cursor;
    use std::path::Path;

    #[test]
    fn a_record_goes_in_as_json_and_comes_out_as_json() {
        let mut builder = ArtifactBuilder::new();
        let data = serde_json::json!({"reason": "no zero", "stage": "integrate"});
        put_json(&mut builder, "/diagnosis", "crumple.Diagnosis.v1", data).unwrap();
        let mut file = Cursor::new(Vec::new());
        builder.write_to(&mut file, &Provenance::new("x", "1", "{}".into(), Vec::new()), Compression::None).unwrap();
        let artifact = Artifact::read(Path::new("x.mcap"), file.get_ref().as_slice()).unwrap();
        let text = artifact.json_text(&artifact.records()[0], JsonForm::Line).unwrap().unwrap();
        assert_eq!(
            text, r#"{"stage":"integrate","reason":"no zero","has_result":false}"#,
            "fields in the order of the type"
        );
        let later = RawRecord { schema: "crumple.Diagnosis.v2".into(), ..artifact.records()[0].clone() };
        assert!(matches!(artifact.json_text(&later, JsonForm::Line), Err(ReadError::Newer { .. })));
        let other = RawRecord { schema: "sensor_msgs/Imu".into(), ..artifact.records()[0].clone() };
        assert!(artifact.json_text(&other, JsonForm::Line).unwrap().is_none());
    }

    #[test]
    fn every_type_known_by_name_has_its_schema() {
        for name in SCHEMAS {
            let schema: Value = serde_json::from_slice(schema_json(name).unwrap()).unwrap();
            assert_eq!(schema["title"], *name);
        }
        assert_eq!(schema_json("sensor_msgs/Imu"), None);
    }

    #[test]
    fn unknown_schemas_and_wrong_values_are_refused() {
        let mut builder = ArtifactBuilder::new();
        let error = put_json(&mut builder, "/x", "crumple.Nonsense.v1", Value::Null).unwrap_err();
        assert!(error.to_string().starts_with("record /x: schema \"crumple.Nonsense.v1\" is unknown"), "{error}");
        let error = put_json(&mut builder, "/notes", "crumple.Notes.v1", serde_json::json!({"stage": 1})).unwrap_err();
        assert!(error.to_string().starts_with("record /notes: not a crumple.Notes.v1: invalid type"), "{error}");
    }

    #[test]
    fn patterns_match_as_documented() {
        for (pattern, topic, matches) in [
            ("/wave/*", "/wave/93/velocity", true),
            ("/wave/*/velocity", "/wave/93/velocity", true),
            ("/wave/*/velocity", "/wave/93/velocity/x", false),
            ("/wave/9?", "/wave/93", true),
            ("/wave/9?", "/wave/9", false),
            ("*", "", true),
            ("**a*b", "xxaxxb", true),
            ("/test", "/tests", false),
        ] {
            assert_eq!(topic_matches(pattern, topic), matches, "{pattern} {topic}");
        }
    }
}

//! JSON Schemas that viewers can read.
//!
//! Viewers of MCAP files parse a small subset of JSON Schema and drop a topic whose schema has a reference, a union
//! with null or nested arrays at its root. So the complete schema stands under `$defs/<Type>`, where validators find it
//! through `allOf` and viewers do not look, and the root's `properties` hold what viewers can show.

use serde_json::{Map, Value, json};

/// The JSON Schema of a record type, `full` as made from the type of this schema name: complete for validators, safe
/// for viewers.
///
/// A record that is an array at its root (`Metrics`, `Modes`) keeps its plain schema: viewers show objects only.
pub(crate) fn viewer_safe_schema(mut full: Value, schema: &str) -> Value {
    let mut definitions = Map::new();
    if let Some(object) = full.as_object_mut() {
        object.remove("$schema");
        if let Some(Value::Object(inner)) = object.remove("$defs") {
            definitions.extend(inner);
        }
    }
    let name = schema.split('.').nth(1).unwrap_or(schema).to_owned();
    let is_object = full.get("type").and_then(Value::as_str) == Some("object");
    let description = full.get("description").cloned().unwrap_or_default();
    let properties = viewer_properties(&full, &definitions, 0);
    definitions.insert(name.clone(), full);
    let mut root = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": schema,
        "description": description,
        "$defs": definitions,
        "allOf": [{ "$ref": format!("#/$defs/{name}") }],
    });
    if is_object {
        root["type"] = json!("object");
        root["properties"] = Value::Object(properties);
    } else {
        root["type"] = json!("array");
    }
    root
}

/// The part of an object's properties that viewers understand.
fn viewer_properties(schema: &Value, definitions: &Map<String, Value>, depth: usize) -> Map<String, Value> {
    let Some(properties) = schema.get("properties").and_then(Value::as_object) else { return Map::new() };
    properties.iter().filter_map(|(key, value)| Some((key.clone(), viewer_value(value, definitions, depth)?))).collect()
}

/// A property without references and nulls; `None` where that is not possible.
fn viewer_value(schema: &Value, definitions: &Map<String, Value>, depth: usize) -> Option<Value> {
    // Records nest three deep at most; the limit ends a recursive type.
    if depth > 4 {
        return None;
    }
    if let Some(reference) = schema.get("$ref").and_then(Value::as_str) {
        return viewer_value(definitions.get(reference.strip_prefix("#/$defs/")?)?, definitions, depth + 1);
    }
    let is_word = |choice: &Value| choice.get("const").is_some_and(Value::is_string);
    if schema.get("oneOf").and_then(Value::as_array).is_some_and(|choices| choices.iter().all(is_word)) {
        return Some(json!({ "type": "string" }));
    }
    if let Some(choices) = schema.get("anyOf").and_then(Value::as_array) {
        let mut others = choices.iter().filter(|c| c.get("type").and_then(Value::as_str) != Some("null"));
        let only = others.next()?;
        return if others.next().is_none() { viewer_value(only, definitions, depth + 1) } else { None };
    }
    let kind = match schema.get("type")? {
        Value::String(kind) => kind.as_str(),
        Value::Array(kinds) => {
            let mut others = kinds.iter().filter_map(Value::as_str).filter(|k| *k != "null");
            let only = others.next()?;
            if others.next().is_some() {
                return None;
            }
            only
        }
        _ => return None,
    };
    match kind {
        "boolean" | "string" | "number" | "integer" => Some(json!({ "type": kind })),
        "array" => {
            let items = schema.get("items")?;
            // A field that is unknown is left out of a record; an entry of a list is null.
            if takes_null(items) {
                return None;
            }
            let items = viewer_value(items, definitions, depth + 1)?;
            (items["type"] != "array").then(|| json!({ "type": "array", "items": items }))
        }
        "object" => {
            let properties = viewer_properties(schema, definitions, depth + 1);
            // A map with free keys has no properties to show.
            (!properties.is_empty()).then(|| json!({ "type": "object", "properties": properties }))
        }
        _ => None,
    }
}

fn takes_null(schema: &Value) -> bool {
    let is_null = |kind: &Value| kind == "null" || kind["type"] == "null";
    [&schema["type"], &schema["anyOf"]].iter().any(|kinds| kinds.as_array().is_some_and(|all| all.iter().any(is_null)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::json_text::without_blanks;
    use crate::layout::record::Record;
    use crate::records::{CandidateV1, ModesV1, StateSpaceV1, TestV1};

    fn schema_of<R: Record>() -> Value {
        R::schema_of_type()
    }

    #[test]
    fn the_text_in_a_file_is_the_schema_of_the_type_as_it_is_written_without_blanks() {
        assert_eq!(
            without_blanks("{\n  \"a b\": \"c \\\" \\\\\", \"d\": [1, 2]\n}\n"),
            b"{\"a b\":\"c \\\" \\\\\",\"d\":[1,2]}"
        );
        for (text, schema) in
            [(TestV1::schema_json(), schema_of::<TestV1>()), (CandidateV1::schema_json(), schema_of::<CandidateV1>())]
        {
            assert_eq!(std::str::from_utf8(text).unwrap(), schema.to_string());
        }
    }

    /// The subset that a viewer's parser takes: object at the root; below it scalars, objects and arrays of those.
    fn viewer_takes(schema: &Value) -> Result<(), String> {
        let kind = schema.get("type").and_then(Value::as_str).ok_or(format!("no plain type in {schema}"))?;
        match kind {
            "boolean" | "string" | "number" | "integer" => Ok(()),
            "object" => schema["properties"].as_object().ok_or("no properties")?.values().try_for_each(viewer_takes),
            "array" if schema["items"]["type"] == "array" => Err("nested array".into()),
            "array" => viewer_takes(&schema["items"]),
            other => Err(format!("type {other}")),
        }
    }

    #[test]
    fn viewers_can_parse_the_schemas_of_objects() {
        for schema in [schema_of::<TestV1>(), schema_of::<CandidateV1>(), schema_of::<StateSpaceV1>()] {
            viewer_takes(&schema).unwrap();
        }
    }

    #[test]
    fn options_references_and_lists_stay_visible() {
        let schema = schema_of::<TestV1>();
        assert_eq!(schema["properties"]["mass_kg"], json!({ "type": "number" }));
        assert_eq!(schema["properties"]["channels"]["items"]["properties"]["cfc"], json!({ "type": "integer" }));
        assert_eq!(schema["properties"]["source"]["properties"]["name"], json!({ "type": "string" }));
        // a matrix is left out for viewers and stands in the full schema
        let model = schema_of::<StateSpaceV1>();
        assert!(model["properties"].get("a").is_none());
        assert!(model["$defs"]["StateSpace"]["properties"]["a"].is_object());
    }

    /// What a viewer cannot show is left out, and only that.
    #[test]
    fn unions_maps_recursion_and_lists_with_gaps_are_left_to_validators() {
        let number = json!({ "type": "number" });
        let full = json!({
            "type": "object",
            "$defs": {
                "Point": { "type": "object", "properties": { "x": number } },
                "Tree": { "type": "object", "properties": { "x": number, "branch": { "$ref": "#/$defs/Tree" } } },
            },
            "properties": {
                "number_or_text": { "anyOf": [number, { "type": "string" }] },
                "point_or_null": { "anyOf": [{ "$ref": "#/$defs/Point" }, { "type": "null" }] },
                "two_kinds": { "type": ["number", "string"] },
                "number_or_null": { "type": ["number", "null"] },
                "gaps": { "type": "array", "items": { "type": ["number", "null"] } },
                "gaps_of_points": {
                    "type": "array", "items": { "anyOf": [{ "$ref": "#/$defs/Point" }, { "type": "null" }] },
                },
                "numbers": { "type": "array", "items": number },
                "matrix": { "type": "array", "items": { "type": "array", "items": number } },
                "by_name": { "type": "object", "additionalProperties": number },
                "tree": { "$ref": "#/$defs/Tree" },
            },
        });
        let schema = viewer_safe_schema(full, "crumple.Made.v1");
        let point = json!({ "type": "object", "properties": { "x": number } });
        // A reference and the object it names are a level each, five in all.
        let level = |inner: Option<&Value>| {
            let mut tree = json!({ "type": "object", "properties": { "x": number } });
            if let Some(inner) = inner {
                tree["properties"]["branch"] = inner.clone();
            }
            tree
        };
        let expected = json!({
            "number_or_null": number,
            "numbers": { "type": "array", "items": number },
            "point_or_null": point,
            "tree": level(Some(&level(None))),
        });
        assert_eq!(schema["properties"], expected);
        assert_eq!(schema["$defs"]["Made"]["properties"].as_object().unwrap().len(), 10);
    }

    #[test]
    fn an_array_record_keeps_a_schema_that_validators_accept() {
        let schema = schema_of::<ModesV1>();
        assert_eq!(schema["type"], "array");
        assert_eq!(schema["$defs"]["Modes"]["items"]["$ref"], "#/$defs/ModeV1");
    }
}

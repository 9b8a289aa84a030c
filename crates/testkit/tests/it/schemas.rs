//! JSON Schemas: `docs/schemas/` holds those of the code, every record fits the schema in its own artifact, and
//! `summary.json` fits its own.
//!
//! `CRUMPLE_WRITE_SCHEMAS=1` writes `docs/schemas/` (`just schemas`), else it is compared.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crumple_artifact::{Artifact, SCHEMAS, schema_json, schema_of_type};
use crumple_report::summary_schema;
use crumple_testkit::kinds::{made_kinds, real_kinds};
use crumple_testkit::programs::run;
use crumple_testkit::workspace;
use jsonschema::Validator;
use serde_json::{Value, json};

fn validator(schema: &Value) -> Validator {
    jsonschema::draft202012::new(schema).unwrap_or_else(|error| panic!("no schema: {error}"))
}

/// What in a value does not fit its schema; `name` is what a fault calls it.
fn faults<'a>(name: &'a str, schema: &'a Validator, value: &'a Value) -> impl Iterator<Item = String> + 'a {
    schema.iter_errors(value).map(move |error| format!("{name}{}: {error}", error.instance_path()))
}

#[test]
fn the_schemas_in_the_docs_are_those_of_the_code() {
    let folder = workspace().join("docs/schemas");
    let of_records = SCHEMAS.iter().map(|name| ((*name).to_owned(), schema_of_type(name).unwrap()));
    let all: BTreeMap<String, Value> =
        of_records.chain([("crumple.summary.v1".to_owned(), summary_schema())]).collect();
    let name_of = |schema: &String| format!("{schema}.json");
    if std::env::var_os("CRUMPLE_WRITE_SCHEMAS").is_some() {
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        for (name, schema) in &all {
            fs::write(folder.join(name_of(name)), format!("{schema:#}\n")).unwrap();
        }
        return;
    }
    let there: Vec<String> = {
        let mut names: Vec<String> =
            fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    assert_eq!(there, all.keys().map(name_of).collect::<Vec<_>>(), "run `just schemas`");
    for (name, schema) in &all {
        let text = fs::read_to_string(folder.join(name_of(name))).unwrap();
        assert!(text == format!("{schema:#}\n"), "docs/schemas/{}: run `just schemas`", name_of(name));
    }
    for name in SCHEMAS {
        // What stands in artifacts is what is built in of these files.
        let built_in = std::str::from_utf8(schema_json(name).unwrap()).unwrap();
        assert_eq!(built_in, all[*name].to_string(), "{name}");
    }
}

/// The schema data of an artifact by the name of the schema, as any reader of MCAP files finds them.
fn schemas_in(path: &Path) -> BTreeMap<String, Validator> {
    let bytes = fs::read(path).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().expect("an artifact has a summary section");
    let schemas = summary.schemas.values().filter(|schema| schema.name != "crumple.WaveBlock.v1");
    schemas.map(|schema| (schema.name.clone(), validator(&serde_json::from_slice(&schema.data).unwrap()))).collect()
}

/// Faults of all records of a run folder and of its summary, and how many records there are.
fn check_folder(folder: &Path) -> (Vec<String>, usize) {
    let (mut found, mut records) = (Vec::new(), 0);
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|ending| ending != "mcap") {
            continue;
        }
        let schemas = schemas_in(&path);
        for raw in Artifact::open(&path).unwrap().records() {
            let value: Value = serde_json::from_slice(&raw.payload).unwrap();
            assert!(value.is_object(), "{}: viewers show objects only", raw.topic);
            found.extend(faults(&raw.topic, &schemas[&raw.schema], &value));
            records += 1;
        }
    }
    let summary: Value = serde_json::from_slice(&fs::read(folder.join("summary.json")).unwrap()).unwrap();
    found.extend(faults("summary.json", &validator(&summary_schema()), &summary));
    (found, records)
}

/// Runs a record; any exit code that leaves a run folder will do.
fn check_run(variables: &[&str], record: &Path, args: &[&str]) -> usize {
    let folder = tempfile::tempdir().unwrap();
    let output = run(variables, folder.path(), record, args);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(matches!(output.status.code(), Some(0 | 4)), "{}: {said}", record.display());
    let (found, records) = check_folder(folder.path());
    assert!(found.is_empty(), "{}: {found:#?}", record.display());
    records
}

#[test]
fn every_record_of_every_kind_of_test_fits_the_schema_in_its_file() {
    let folder = tempfile::tempdir().unwrap();
    for kind in made_kinds(folder.path()).unwrap().into_iter().chain(real_kinds()) {
        let records = check_run(kind.variables, &kind.path, kind.flags);
        assert!(records > 8, "{}: {records} records", kind.name);
    }
}

/// A check that accepts everything shows nothing.
#[test]
fn a_wrong_record_does_not_fit() {
    let schema: Value = serde_json::from_slice(schema_json("crumple.Events.v1").unwrap()).unwrap();
    let found: Vec<String> =
        faults("/events", &validator(&schema), &json!({ "channel": 1, "dynamic_crush_m": "deep" })).collect();
    assert!(found.iter().any(|fault| fault.contains("dynamic_crush_m")), "{found:?}");
    assert!(!validator(&summary_schema()).is_valid(&json!({ "schema": "crumple.summary.v1" })));
}

/// Another platform's `exp`, `sin` and `cos` may differ in the last digit; the double model multiplies that by 2000
/// steps at most.
const RELATIVE: f64 = 1e-12;

fn close(found: f64, wanted: f64, scale: f64) -> bool {
    (found - wanted).abs() <= RELATIVE * scale.max(wanted.abs())
}

fn same(found: &Value, wanted: &Value, path: &str) {
    match (found, wanted) {
        (Value::Number(a), Value::Number(b)) => {
            // A checkpoint value near a zero crossing is compared on the scale of ordinary motion.
            assert!(close(a.as_f64().unwrap(), b.as_f64().unwrap(), 1e-2), "{path}: {a} {b}");
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{path}");
            for (k, (a, b)) in a.iter().zip(b).enumerate() {
                same(a, b, &format!("{path}[{k}]"));
            }
        }
        (Value::Object(a), Value::Object(b)) => {
            assert!(a.keys().eq(b.keys()), "{path}");
            for (key, a) in a {
                same(a, &b[key], &format!("{path}.{key}"));
            }
        }
        _ => assert_eq!(found, wanted, "{path}"),
    }
}

#[test]
fn committed_files_are_the_generators() {
    for fixture in crumple_testkit::fixture::fixtures().unwrap() {
        let folder = workspace().join("fixtures").join(fixture.name);
        let csv = fs::read_to_string(folder.join("crash.csv")).unwrap();
        let truth: Value = serde_json::from_str(&fs::read_to_string(folder.join("truth.json")).unwrap()).unwrap();
        same(&truth, &fixture.truth, fixture.name);
        assert_eq!(csv.lines().count(), fixture.csv.lines().count());
        for (line, (found, wanted)) in csv.lines().zip(fixture.csv.lines()).enumerate() {
            let numbers = |text: &str| text.split_once(',').and_then(|(t, a)| Some((t.parse().ok()?, a.parse().ok()?)));
            match (numbers(found), numbers(wanted)) {
                (Some((t, a)), Some((u, b))) => {
                    let _: (f64, f64) = (t, a);
                    // Rounding is that of the largest terms, some 30 g, also where the acceleration passes through
                    // zero.
                    assert!(t == u && close(a, b, 1.0), "{} line {}: {found} {wanted}", fixture.name, line + 1);
                }
                _ => assert_eq!(found, wanted, "{} line {}", fixture.name, line + 1),
            }
        }
    }
}

#[test]
fn records_are_quiet_before_contact_and_negative_after() {
    for fixture in crumple_testkit::fixture::fixtures().unwrap() {
        let samples: Vec<(f64, f64)> = fixture
            .csv
            .lines()
            .filter_map(|line| line.split_once(','))
            .filter_map(|(t, a)| Some((t.parse().ok()?, a.parse().ok()?)))
            .collect();
        assert_eq!(samples.len(), 2501);
        assert_eq!((samples[0].0, samples[500].0, samples[2500].0), (-0.05, 0.0, 0.2));
        let quiet = samples[..500].iter().all(|(_, a)| *a == 0.0);
        assert_eq!(quiet, fixture.name != "noisy");
        // SAE J211: a frontal pulse decelerates.
        assert!(samples[500..1000].iter().map(|(_, a)| a).sum::<f64>() < 0.0);
    }
}

//! What a stage reads of the artifacts of a run: how a motion was made, the force on the wall, which files they are.

use std::path::{Path, PathBuf};

use crumple_artifact::{ArtifactBuilder, Compression, Provenance, put_json};
use crumple_signal::{IntegrationRule, Measurement, QuantityKind, Sampled, TwoPassFilter};
use crumple_stage::records::{ChannelFilterV1, EventsV1, TestV1};
use crumple_stage::{Inputs, Record, Tests, artifacts_of_a_run, load_artifacts, load_tests};
use serde_json::{Value, json};

const DT_S: f64 = 1e-3;
const COEFFICIENTS: [f64; 5] = [0.1, 0.2, 0.1, 0.5, -0.2];
const FILTER: TwoPassFilter = TwoPassFilter { coefficients: COEFFICIENTS, samples_added: 10 };

/// A filter of CFC 60 on a channel.
fn class_filter() -> Value {
    json!({
        "cfc": 60, "mode": "iso6487", "samples_added": 10, "coefficients": COEFFICIENTS, "zero_level_removed": 0.0,
        "notes": []
    })
}

fn no_filter() -> Value {
    json!({"mode": "none", "samples_added": 0, "coefficients": [], "zero_level_removed": 0.0, "notes": []})
}

fn channel(id: &str, quantity: &str, location: &str) -> Value {
    let unit = if quantity == "force" { "N" } else { "m/s^2" };
    json!({"id": id, "quantity": quantity, "location": location, "unit": unit, "status": "valid"})
}

/// 120 samples from 50 ms before zero of the axis on.
fn wave(dt_s: f64) -> Sampled {
    Sampled::new(-0.05, dt_s, (0..120).map(|k| f64::from(k % 7) - 3.0).collect()).unwrap()
}

/// An artifact in a folder, of records as JSON and waves.
fn write(path: &Path, stage: &str, records: &[(&str, &'static str, Value)], waves: &[(&str, QuantityKind, f64)]) {
    let mut builder = ArtifactBuilder::new();
    for (topic, schema, record) in records {
        put_json(&mut builder, topic, schema, record.clone()).unwrap();
    }
    for (id, quantity, dt_s) in waves {
        builder.wave(id, *quantity, wave(*dt_s)).unwrap();
    }
    let provenance = Provenance::new(stage, "0.1.0", "{}".into(), Vec::new());
    builder.write(path, &provenance, Compression::None).unwrap();
}

fn test(digest: &str, channels: &[Value]) -> Value {
    json!({"title": "", "source": {"format": "csv", "name": "a.csv", "digest": digest}, "channels": channels})
}

/// A run with one accelerometer and its filter.
fn inputs(filter: Option<Value>, dt_s: f64) -> Inputs {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("2-filter.mcap");
    let mut records = vec![("/test", TestV1::SCHEMA, test("blake3:aa", &[channel("1", "acceleration", "sill")]))];
    records.extend(filter.map(|filter| ("/filter/1", ChannelFilterV1::SCHEMA, filter)));
    write(&path, "filter", &records, &[("1", QuantityKind::Acceleration, dt_s)]);
    load_artifacts(&[path]).unwrap().input
}

fn events(rule: Option<&str>, start: &str) -> EventsV1 {
    EventsV1 {
        channel: "1".to_owned(),
        rule: rule.map(str::to_owned),
        start: Some(start.to_owned()),
        ..EventsV1::default()
    }
}

fn steps(filter: Option<Value>, dt_s: f64, events: &EventsV1) -> Measurement {
    inputs(filter, dt_s).recording_steps(events, "1", &wave(DT_S)).unwrap()
}

#[test]
fn a_class_filter_with_its_coefficients_is_known() {
    let found = steps(Some(class_filter()), DT_S, &events(Some("trapezoid"), "contact"));
    assert_eq!(found.filter, Some(FILTER));
    assert!(found.rule == Some(IntegrationRule::Trapezoid) && found.from_contact, "{found:?}");
    assert_eq!((found.dt_s, found.samples), (DT_S, 120));
    // The first sample is 50 ms before contact.
    assert!((found.first_s + 0.05).abs() < 1e-12, "{}", found.first_s);
    let euler = steps(Some(class_filter()), DT_S, &events(Some("forward-euler"), "record-start"));
    assert!(euler.rule == Some(IntegrationRule::ForwardEuler) && !euler.from_contact, "{euler:?}");
    // What a filter mirrors at the first sample is left out of the noise before the event.
    let before = |filter: Value| steps(Some(filter), DT_S, &events(None, "contact")).before_event;
    let (filtered, raw) = (before(class_filter()).unwrap(), before(no_filter()).unwrap());
    assert_eq!((filtered.samples, filtered.noise_samples + 10), (raw.samples, raw.noise_samples));
}

#[test]
fn no_filter_is_known_too_and_a_foreign_one_or_another_rate_or_rule_is_not() {
    let trapezoid = events(Some("trapezoid"), "contact");
    let untouched = steps(Some(no_filter()), DT_S, &trapezoid);
    assert!(!untouched.is_exact() && untouched.filter.is_none(), "{untouched:?}");
    let mut foreign = class_filter();
    foreign["mode"] = json!("butterworth");
    let mut of_no_class = class_filter();
    of_no_class.as_object_mut().unwrap().remove("cfc");
    let mut moving = no_filter();
    moving["width_s"] = json!(0.004);
    let mut resampled = class_filter();
    resampled["resampled_to_hz"] = json!(1000.0);
    for filter in [Some(foreign), Some(of_no_class), Some(moving), Some(resampled), None] {
        let found = steps(filter.clone(), DT_S, &trapezoid);
        assert!(found.is_exact() && found.filter.is_none(), "{filter:?}");
    }
    assert!(steps(Some(class_filter()), DT_S, &events(Some("simpson"), "contact")).is_exact());
    // The acceleration at half the rate of the motion is not what the motion was made from.
    let other = steps(Some(class_filter()), 2.0 * DT_S, &trapezoid);
    assert!(other.is_exact() && other.before_event.is_none() && other.dt_s == DT_S, "{other:?}");
}

#[test]
fn a_channel_filtered_before_it_was_recorded_is_not_unfiltered() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("2-filter.mcap");
    let mut sensor = channel("1", "acceleration", "sill");
    sensor["cfc"] = json!(180);
    let records =
        [("/test", TestV1::SCHEMA, test("blake3:aa", &[sensor])), ("/filter/1", ChannelFilterV1::SCHEMA, no_filter())];
    write(&path, "filter", &records, &[("1", QuantityKind::Acceleration, DT_S)]);
    let inputs = load_artifacts(&[path]).unwrap().input;
    assert!(inputs.recording_steps(&events(None, "contact"), "1", &wave(DT_S)).unwrap().is_exact());
}

/// The force on the wall of two cells and a belt, each with its filter.
fn wall(filters: [Option<Value>; 2], of_the_belt: Option<Value>) -> Option<(Sampled, Measurement)> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("3-integrate.mcap");
    let channels = [
        channel("f1", "force", "Barrier, row 1"),
        channel("f2", "force", " barrier, row 2"),
        channel("b", "force", "belt"),
        channel("a", "acceleration", "barrier"),
    ];
    let mut records = vec![("/test", TestV1::SCHEMA, test("blake3:aa", &channels))];
    let [first, second] = filters;
    let foreign = json!({"mode": "butterworth", "samples_added": 0, "coefficients": [], "zero_level_removed": 0.0,
                         "notes": []});
    let of_all =
        [("/filter/f1", first), ("/filter/f2", second), ("/filter/b", of_the_belt), ("/filter/a", Some(foreign))];
    records.extend(of_all.into_iter().filter_map(|(topic, f)| Some((topic, ChannelFilterV1::SCHEMA, f?))));
    write(&path, "integrate", &records, &[("barrier/force", QuantityKind::Force, DT_S)]);
    load_artifacts(&[path]).unwrap().input.wall_force().unwrap()
}

#[test]
fn the_force_on_the_wall_is_known_where_all_cells_went_through_one_filter() {
    let mut other = class_filter();
    other["cfc"] = json!(180);
    other["coefficients"] = json!([0.3, 0.2, 0.1, 0.5, -0.2]);
    let mut resampled = class_filter();
    resampled["resampled_to_hz"] = json!(1000.0);
    let (force, steps) = wall([Some(class_filter()), Some(class_filter())], Some(other.clone())).unwrap();
    assert_eq!((force.len(), steps.samples, steps.filter), (120, 120, Some(FILTER)));
    assert!(!steps.is_exact() && !steps.from_contact && (steps.first_s + 0.05).abs() < 1e-12, "{steps:?}");
    assert!(!wall([Some(class_filter()), None], None).unwrap().1.is_exact(), "a cell without data has no filter");
    for second in [other, resampled, no_filter()] {
        let steps = wall([Some(class_filter()), Some(second.clone())], None).unwrap().1;
        assert!(steps.is_exact() && steps.filter.is_none(), "{second}");
    }
    assert!(wall([None, None], None).unwrap().1.is_exact());
    assert!(inputs(None, DT_S).wall_force().unwrap().is_none(), "no load cells");
}

#[test]
fn records_and_waves_of_several_artifacts_are_found_by_topic_the_later_stage_first() {
    let folder = tempfile::tempdir().unwrap();
    let [early, late] = ["2-filter.mcap", "3-integrate.mcap"].map(|name| folder.path().join(name));
    let records = |samples: u64| {
        let mut filter = no_filter();
        filter["samples_added"] = json!(samples);
        [("/test", TestV1::SCHEMA, test("blake3:aa", &[])), ("/filter/1", ChannelFilterV1::SCHEMA, filter)]
    };
    let force = QuantityKind::Force;
    write(&early, "filter", &records(1), &[("1", force, DT_S), ("2", force, DT_S)]);
    write(&late, "integrate", &records(2), &[("1", force, 2.0 * DT_S)]);
    let inputs = load_artifacts(&[late, early]).unwrap().input;
    let stages: Vec<Option<&str>> = inputs.artifacts().iter().map(|artifact| artifact.stage()).collect();
    assert_eq!(stages, [Some("filter"), Some("integrate")]);
    let found: Option<ChannelFilterV1> = inputs.record_if("/filter/1").unwrap();
    assert_eq!(found.unwrap().samples_added, 2);
    let all: Vec<(String, ChannelFilterV1)> = inputs.records("/filter/").unwrap();
    assert_eq!(all.iter().map(|(id, f)| (id.as_str(), f.samples_added)).collect::<Vec<_>>(), [("1", 2)]);
    assert_eq!(inputs.wave_if("1").unwrap().sampled.dt_s(), 2.0 * DT_S);
    assert_eq!(inputs.waves().map(|(id, _)| id).collect::<Vec<_>>(), ["1", "2"]);
    assert_eq!(inputs.test().unwrap().source.digest, "blake3:aa");
}

#[test]
fn a_run_folder_holds_its_artifacts_in_the_order_of_the_stages() {
    let folder = tempfile::tempdir().unwrap();
    let refused = artifacts_of_a_run(folder.path()).unwrap_err().to_string();
    assert!(refused.ends_with("holds no artifact"), "{refused}");
    let hint = || crumple_stage::hint_for_a_run(folder.path());
    assert!(hint().contains("RECORD makes one"), "{}", hint());
    for (pipeline, expected) in [("default", "did you mean "), ("papers", "name one of its 2 runs, such as ")] {
        let below = folder.path().join(pipeline);
        std::fs::create_dir(&below).unwrap();
        std::fs::write(below.join("1-ingest.mcap"), "").unwrap();
        let first = folder.path().join("default").display().to_string();
        assert!(hint().starts_with(&format!("{expected}{first}")), "{}", hint());
    }
    for name in ["3-integrate.mcap", "1-ingest.mcap", ".2-filter.mcap", "report.html"] {
        std::fs::write(folder.path().join(name), "").unwrap();
    }
    let names = ["1-ingest.mcap", "3-integrate.mcap"].map(|name| folder.path().join(name));
    assert_eq!(artifacts_of_a_run(folder.path()).unwrap(), names);
    assert!(artifacts_of_a_run(&folder.path().join("none")).unwrap_err().to_string().starts_with("cannot read"));
}

#[test]
fn several_tests_keep_their_names_and_one_record_is_not_two_tests() {
    let folder = tempfile::tempdir().unwrap();
    let artifact = |name: &str, digest: &str| -> PathBuf {
        let path = folder.path().join(name);
        write(&path, "integrate", &[("/test", TestV1::SCHEMA, test(digest, &[]))], &[]);
        path
    };
    let (a, b) = (artifact("a.mcap", "blake3:aa"), artifact("b.mcap", "blake3:bb"));
    let nameless = artifact("c.mcap", "");
    let named = |pairs: &[(&str, &PathBuf)]| -> Vec<PathBuf> {
        pairs.iter().map(|(name, path)| PathBuf::from(format!("{name}:{}", path.display()))).collect()
    };
    let loaded = load_tests(&named(&[("x", &a), ("y", &b)])).unwrap();
    let kinds: Vec<&str> = loaded.digests.iter().map(|digest| digest.kind.as_str()).collect();
    assert_eq!(kinds, ["x:integrate", "y:integrate"]);
    let Tests::Several(tests) = loaded.input else { panic!("two names are two tests") };
    assert_eq!(tests.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["x", "y"]);
    let twice = load_tests(&named(&[("x", &a), ("y", &a)])).unwrap_err().to_string();
    assert_eq!(twice, "x and y are one record");
    assert!(load_tests(&named(&[("x", &nameless), ("y", &nameless)])).is_ok(), "who states no digest is believed");
}

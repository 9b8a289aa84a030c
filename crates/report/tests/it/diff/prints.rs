//! What people read of a comparison: which lines, in which order, how many.

use crumple_artifact::records::NotesV1;
use crumple_artifact::{ArtifactBuilder, Compression, Provenance};
use crumple_diff::{
    Base, CompareSettings, Comparison, FileReport, TextOptions, Tolerances, compare_json, parse_rules, write_text,
};
use serde_json::{Value, json};

use super::{Made, diff, pair};

/// The text of a comparison of one topic, `all` or not.
fn text(topic: &str, a: &Value, b: &Value, all: bool) -> Vec<String> {
    let report = compare_json(topic, a, b, &CompareSettings::default());
    let comparison = Comparison::new("a".into(), "b".into(), false, vec![FileReport::json("x.mcap", report)]);
    let mut out = Vec::new();
    write_text(&comparison, TextOptions { all }, &mut out).unwrap();
    String::from_utf8(out).unwrap().lines().map(str::to_owned).collect()
}

fn places(lines: &[String]) -> Vec<&str> {
    lines.iter().filter_map(|line| line.split_once(", ")?.1.split_once(": ").map(|(place, _)| place)).collect()
}

#[test]
fn crush_and_fit_come_first_and_remarks_last() {
    let record = |x: f64| {
        json!({
            "a_first": x, "dynamic_crush_m": x, "fit": {"fit_percent": x}, "notes": [format!("word{x}")],
            "simulation": {"time_of_dynamic_crush_s": x}, "zeta": x,
        })
    };
    let lines = text("/simulation/x", &record(1.0), &record(2.0), false);
    let order = ["dynamic_crush_m", "simulation.time_of_dynamic_crush_s", "fit.fit_percent", "a_first", "zeta"];
    assert_eq!(places(&lines), order);
    assert_eq!(lines[5..], ["/simulation/x: 1 more (--all shows them)", "different: 1 of 1 topics"]);
    let all = text("/simulation/x", &record(1.0), &record(2.0), true);
    assert_eq!(places(&all).last(), Some(&"notes[0]"));
}

#[test]
fn of_metrics_a_few_are_shown_and_the_rest_is_counted() {
    let metrics = |x: f64| (0..9).map(|k| json!({"name": format!("m{k}"), "value": x, "unit": "1"})).collect::<Value>();
    let lines = text("/metrics", &metrics(1.0), &metrics(2.0), false);
    let shown: Vec<String> = (0..9).map(|k| format!("[m{k}].value")).collect();
    assert_eq!(places(&lines), shown, "five first, four with the rest");
    assert_eq!(places(&text("/metrics", &metrics(1.0), &metrics(2.0), true)), shown);
    let many = |x: f64| (0..12).map(|k| json!({"name": format!("m{k:02}"), "value": x})).collect::<Value>();
    let lines = text("/metrics", &many(1.0), &many(2.0), false);
    assert_eq!(places(&lines).len(), 10);
    assert!(lines.contains(&"/metrics: 2 more (--all shows them)".to_owned()), "{lines:?}");
    // A unit of a metric in a summary is no value of one: it stands with the rest, behind the events.
    let summary = |x: f64| {
        let olc = json!({"unit": format!("u{x}"), "value": x});
        json!({"events": {"z": x}, "metrics": {"olc": olc}, "a": {"value": x}})
    };
    let lines = text("summary.json", &summary(1.0), &summary(2.0), false);
    assert_eq!(places(&lines), ["events.z", "metrics.olc.value", "a.value", "metrics.olc.unit"]);
}

#[test]
fn what_does_not_count_is_told_a_few_times_too() {
    let notes = |x: f64, n: usize| json!({"notes": vec![format!("zero level {x} m/s^2"); n]});
    let lines = text("/notes", &notes(1.5, 7), &notes(2.5, 7), false);
    assert_eq!(lines.len(), 7, "{lines:?}");
    assert_eq!(lines[5], "/notes: 2 more  (for information) (--all shows them)");
    assert!(lines[6].ends_with("none differs; 7 texts differ and do not count"), "{}", lines[6]);
    assert_eq!(text("/notes", &notes(1.5, 5), &notes(2.5, 5), false).len(), 6);
    assert_eq!(text("/notes", &notes(1.5, 7), &notes(2.5, 7), true).len(), 8);
}

/// An artifact with a note at each of some topics, and the options of its stage.
fn write(path: &std::path::Path, topics: &[(&str, &str)], config: &str) {
    let mut builder = ArtifactBuilder::new();
    for (topic, note) in topics {
        builder.put(topic, &NotesV1 { stage: "x".into(), notes: vec![(*note).to_owned()] }).unwrap();
    }
    let provenance = Provenance::new("filter", "0.1.0", config.into(), Vec::new());
    builder.write(path, &provenance, Compression::None).unwrap();
}

#[test]
fn topics_of_one_side_are_named_and_remarks_come_last() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    write(&at("a.mcap"), &[("/notes", "a"), ("/z", "one"), ("/zz", "same")], "{}");
    write(&at("b.mcap"), &[("/notes", "b"), ("/y", "1"), ("/z", "two"), ("/zz", "same")], "{}");
    let output = diff(folder.path(), &["a.mcap", "b.mcap"]);
    let lines: Vec<&str> = output.stdout.lines().skip(1).collect();
    assert_eq!(lines[0], "/y: only in b.mcap");
    assert!(lines[1].starts_with("/z, notes[0]: \"one\"  \"two\""), "{}", lines[1]);
    assert!(lines[2].starts_with("/notes, notes[0]"), "remarks come last: {}", lines[2]);
    assert_eq!((lines[3], output.code), ("different: 3 of 4 topics", 1));
    let json: Value = serde_json::from_str(&diff(folder.path(), &["b.mcap", "a.mcap", "--json"]).stdout).unwrap();
    assert_eq!(json["files"][0]["file"]["name"], "b.mcap");
}

#[test]
fn options_are_compared_exactly_and_count_only_where_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    write(&at("a.mcap"), &[("/notes", "a")], r#"{"cutoff_hz":60.0}"#);
    write(&at("b.mcap"), &[("/notes", "b")], r#"{"cutoff_hz":60.00000000001}"#);
    write(&at("c.mcap"), &[("/notes", "b")], r#"{"cutoff_hz":60.0}"#);
    let conclusion = |args: &[&str]| diff(folder.path(), args).stdout.lines().last().unwrap().to_owned();
    assert_eq!(conclusion(&["a.mcap", "b.mcap", "--provenance"]), "different: 1 of 1 topics, provenance");
    assert_eq!(conclusion(&["a.mcap", "c.mcap", "--provenance"]), "different: 1 of 1 topics");
    assert_eq!(conclusion(&["a.mcap", "b.mcap"]), "different: 1 of 1 topics");
    let text = diff(folder.path(), &["a.mcap", "b.mcap"]).stdout;
    assert!(text.contains("provenance, config.cutoff_hz: 60.0  60.00000000001  (for information)"), "{text}");
}

#[test]
fn a_frame_that_differs_is_not_counted_among_the_samples() {
    let mut changed = Made::default();
    changed.samples.pop();
    changed.samples[120] += 0.25;
    changed.samples[130] += 0.5;
    let folder = pair(&changed);
    let text = diff(folder.path(), &["a.mcap", "b.mcap"]).stdout;
    assert!(text.contains("/wave/93, number of samples: 200  199"), "{text}");
    assert!(text.contains(", the first of 2 that differ of 1"), "{text}");
}

#[test]
fn what_cannot_be_compared_is_said_with_what_to_do() {
    let folder = pair(&Made::default());
    std::fs::create_dir(folder.path().join("run")).unwrap();
    std::fs::write(folder.path().join("x.json"), "{").unwrap();
    std::fs::write(folder.path().join("y.json"), "{}").unwrap();
    std::fs::write(folder.path().join("rules.toml"), "\"/wave/*\" = 5").unwrap();
    for (args, words, hint) in [
        (&["run", "a.mcap"][..], "run is a folder, a.mcap is a file", "give two artifacts"),
        (&["x.json", "a.mcap"], "x.json is a JSON file, a.mcap is a file", "give two artifacts"),
        (&["run", "run"], "run: no run folder", "give the folder that holds 1-ingest.mcap"),
        (&["x.json", "y.json"], "x.json: not JSON", "write the report again"),
        (&["a.mcap", "none.mcap"], "cannot read none.mcap", "check the path"),
        (&["a.mcap", "b.mcap", "--tolerance", "rules.toml"], "tolerances: ", "write lines like"),
        (&["a.mcap", "b.mcap", "--abs=-1"], "expected a number from 0", ""),
        (&["a.mcap", "b.mcap", "--rel", "inf"], "expected a number from 0", ""),
        (&["a.mcap", "b.mcap", "--rel", "NaN"], "expected a number from 0", ""),
    ] {
        let output = diff(folder.path(), args);
        assert_eq!(output.code, 2, "{args:?}: {}", output.stdout);
        assert!(output.stderr.contains(words) && output.stderr.contains(hint), "{args:?}: {}", output.stderr);
    }
}

fn differing(topic: &str, a: &Value, b: &Value, settings: &CompareSettings) -> Vec<String> {
    compare_json(topic, a, b, settings).differences.into_iter().map(|difference| difference.place).collect()
}

#[test]
fn of_two_rules_the_one_that_says_more_counts() {
    let (a, b) = (json!({"x": 1.0}), json!({"x": 2.0}));
    for (rules, same) in [
        ("\"/z*\" = { abs = 9.0 }\n\"/zeta\" = { abs = 0.0 }", false),
        ("\"/z*\" = { abs = 0.0 }\n\"/zeta\" = { abs = 9.0 }", true),
        ("\"/zeta#*\" = { abs = 9.0 }\n\"/zet?#x\" = { abs = 0.0 }", false),
        ("\"/?eta#*\" = { abs = 0.0 }\n\"*#x*\" = { abs = 9.0 }", false),
    ] {
        let tolerances = Tolerances { rules: parse_rules(rules).unwrap(), ..Tolerances::default() };
        let settings = CompareSettings { tolerances, ..CompareSettings::default() };
        assert_eq!(differing("/zeta", &a, &b, &settings).is_empty(), same, "{rules}");
    }
}

#[test]
fn whole_numbers_are_told_apart_to_the_last_and_compared_within_tolerance() {
    let of = |a: u64, b: u64, base| {
        let tolerances = Tolerances { base, ..Tolerances::default() };
        let settings = CompareSettings { tolerances, ..CompareSettings::default() };
        differing("/x", &json!({"n": a}), &json!({"n": b}), &settings).is_empty()
    };
    assert!(!of(1 << 53, (1 << 53) + 1, Base::Computation) && of(1 << 53, 1 << 53, Base::Exact));
    assert!(of(1000, 1001, Base::Engineering) && !of(1000, 1010, Base::Engineering));
    let matrix = |small: f64| json!({"m": [[1e6, 2.0], [3.0, small]]});
    let engineering = Tolerances { base: Base::Engineering, ..Tolerances::default() };
    let settings = CompareSettings { tolerances: engineering, ..CompareSettings::default() };
    assert!(differing("/x", &matrix(4.0), &matrix(400.0), &settings).is_empty(), "of the largest in the matrix");
    let mixed = |small: f64| json!({"m": [1e6, "word", small]});
    assert_eq!(differing("/x", &mixed(4.0), &mixed(400.0), &settings), ["m[2]"], "no list of numbers");
}

/// A candidate of a summary: value and standard deviation of its two parameters, its figures.
fn candidate(id: &str, k_deviation: f64, figures: [f64; 3]) -> Value {
    let [fit, aicc, standard] = figures;
    json!({
        "id": id,
        "parameters": {"k": 10.0, "c": 5.0},
        "uncertainty": {"standard_deviation": {"k": k_deviation, "c": standard}},
        "simulation": {"fit_percent": fit, "aicc": aicc},
        "difference_with_priors": aicc,
        "recommended": fit > 90.0,
    })
}

#[test]
fn a_parameter_that_one_side_leaves_open_is_a_difference_and_hides_no_other() {
    let of = |open_a: bool, open_b: bool| {
        let side = |open: bool, standard: f64| {
            let deviation = if open { 20.0 } else { 0.1 };
            json!({"candidates": [candidate("x", deviation, [95.0, 1.0, standard])]})
        };
        differing("summary.json", &side(open_a, 0.1), &side(open_b, 0.4), &CompareSettings::default())
    };
    let c = "candidates[x].uncertainty.standard_deviation.c".to_owned();
    assert_eq!((of(true, true), of(false, false)), (vec![c.clone()], vec![c.clone()]));
    for found in [of(true, false), of(false, true)] {
        assert!(found.contains(&"candidates[x].parameters.k".to_owned()) && found.contains(&c), "{found:?}");
    }
    // Where the open parameter has the same value, what follows from it is compared.
    let side = |fit: f64| json!({"candidates": [candidate("x", 20.0, [fit, 1.0, 0.1])]});
    let found = differing("summary.json", &side(90.02), &side(89.98), &CompareSettings::default());
    assert_eq!(found, ["candidates[x].recommended", "candidates[x].simulation.fit_percent"]);
}

#[test]
fn what_hangs_on_a_candidate_with_open_parameters_is_one_of_many_alike() {
    let of = |topic: &str, place: Value, other: Value, base: Base| {
        let tolerances = Tolerances { open: ["x/fit/1".to_owned()].into(), base, ..Tolerances::default() };
        differing(topic, &place, &other, &CompareSettings { tolerances, ..CompareSettings::default() })
    };
    let simulation = |crush: f64, energy: f64| json!({"dynamic_crush_m": crush, "energy_j": energy});
    let line = |misfit: f64| json!({"candidates": [{"id": "x/fit/1", "misfit": misfit}], "misfit": misfit});
    for base in [Base::Computation, Base::Engineering] {
        let found = of("/simulation/x/fit/1", simulation(0.5, 1.0), simulation(0.502, 2.0), base);
        assert_eq!(found, ["dynamic_crush_m"]);
        assert_eq!(of("/simulation/x/fit/10", simulation(0.5, 1.0), simulation(0.5, 2.0), base), ["energy_j"]);
        let of_line = ["candidates[x/fit/1].misfit", "misfit"];
        assert_eq!(of("/recommendation", line(1.0), line(2.0), base), of_line, "how well it fits is compared");
    }
    assert_eq!(of("/simulation/x/fit/1", simulation(0.5, 1.0), simulation(0.5, 2.0), Base::Exact), ["energy_j"]);
}

#[test]
fn rankings_may_differ_in_the_order_of_equals_alone() {
    for (key, near, far) in [("ranking", 1.5, 3.0), ("ranking_by_aicc", 1.5, 3.0)] {
        let side = |gap: f64, order: [&str; 3]| {
            let all = [("x", 50.0), ("y", 50.0 + gap), ("z", 70.0)];
            let candidates: Vec<Value> = all.map(|(id, f)| candidate(id, 0.1, [f, f, 0.1])).into();
            json!({key: order, "candidates": candidates})
        };
        let of = |gap: f64, order: [&str; 3]| {
            let report = compare_json(
                "summary.json",
                &side(gap, ["x", "y", "z"]),
                &side(gap, order),
                &CompareSettings::default(),
            );
            (report.same, report.values)
        };
        let same = of(near, ["x", "y", "z"]);
        assert!(same.0);
        assert_eq!(of(near, ["y", "x", "z"]), same, "{key}: a ranking of equals is one value compared");
        assert!(!of(far, ["y", "x", "z"]).0 && !of(near, ["z", "y", "x"]).0, "{key}");
    }
}

//! `crumple compare TEST SIM --validate` on records of which the truth is known: a set of the testkit, and those of the
//! reference where they are here.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crumple_testkit::programs::binary;
use crumple_testkit::{shared, simulated};
use serde_json::Value;

fn crumple(folder: &Path, words: &[&str]) -> Output {
    Command::new(binary("crumple")).args(words).current_dir(folder).output().unwrap()
}

fn said(output: &Output) -> String {
    let text = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    // Lines are wrapped.
    text.concat().replace(['\u{a0}', '\n'], " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

fn json(folder: &Path) -> Value {
    let mut value: Value = serde_json::from_str(&fs::read_to_string(folder.join("v.json")).unwrap()).unwrap();
    value["simulations"][0].take()
}

/// The ratios of the segments of a force.
fn ratios(validation: &Value, force: &str) -> Vec<f64> {
    let segments = validation["segments"][force].as_array().unwrap();
    segments.iter().map(|segment| segment["ratio"].as_f64().unwrap_or(f64::NAN)).collect()
}

#[track_caller]
fn near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} within {tolerance}");
}

#[test]
fn records_with_flags_are_run_and_the_faulty_part_of_the_curve_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let set = simulated::faulty_simulation().unwrap();
    fs::write(folder.path().join("crash.csv"), &set.test).unwrap();
    fs::create_dir(folder.path().join("H1")).unwrap();
    fs::write(folder.path().join("H1/binout0000"), &set.binout).unwrap();
    let flags = ["--units", "mm-ms-kg", "--node", "rear sill"];
    let words = ["compare", "crash.csv", "H1", "--validate", "--json=v.json", "--markdown", "v.md"];
    let required = ["--require", "crush<=20mm"];
    let output = crumple(folder.path(), &[&words[..], &flags, &required].concat());
    let text = said(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("required crush<=20mm"), "{text}");
    let found = json(folder.path());
    let difference = found["differences"].as_array().unwrap().iter().find(|d| d["name"] == "dynamic_crush").unwrap();
    // A millimetre: sampling and the filter of the test.
    near(difference["difference"].as_f64().unwrap(), set.crush_m[1] - set.crush_m[0], 1e-3);
    let [sentence, place, _] = [0, 1, 2].map(|k| found["sentences"][k].as_str().unwrap().replace('\u{a0}', " "));
    assert!(sentence.starts_with("The simulation is softer than the test"), "{sentence}");
    assert!(place.contains("Its front is too soft from 300 to "), "{place}");
    for (k, ratio) in ratios(&found, "wall").into_iter().enumerate() {
        // The curve goes from 1 to 0.75 between 280 and 320 mm.
        near(ratio, if k < 3 { 1.0 } else { 0.75 }, if k == 2 || k == 3 { 0.03 } else { 0.01 });
    }
    // What was typed stands in the Markdown, and does the same again.
    let markdown = fs::read_to_string(folder.path().join("v.md")).unwrap();
    let typed = "crumple compare crash.csv H1 --validate --json=v.json --markdown v.md --units mm-ms-kg --node 'rear \
                 sill' --require 'crush<=20mm'";
    assert!(markdown.contains(typed), "{markdown}");
    // A flag of records where none is, and a record that is refused.
    let runs = ["compare", "runs/crash/default", "runs/H1/default", "--validate", "--node", "7"];
    let output = crumple(folder.path(), &runs);
    assert!(output.status.code() == Some(2) && said(&output).contains("--node is a flag of a record"), "{output:?}");
    let output = crumple(folder.path(), &["compare", "crash.csv", "H1", "--validate", "--node", "5"]);
    assert!(output.status.code() == Some(3) && said(&output).contains("--units mm-ms-kg"), "{}", said(&output));
    let output =
        crumple(folder.path(), &["compare", "runs/crash/default", "crash.csv", "runs/H1/default", "--validate"]);
    let text = said(&output);
    assert!(output.status.code() == Some(0) && text.matches("softer than the test").count() == 2, "{text}");
    assert!(text.contains("against"), "{text}");
}

/// A test and the folders of as many simulations, in a folder of their own.
fn records(test: &str, simulations: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("crash.csv"), test).unwrap();
    let set = simulated::faulty_simulation().unwrap();
    for name in simulations {
        fs::create_dir(folder.path().join(name)).unwrap();
        fs::write(folder.path().join(name).join("binout0000"), &set.binout).unwrap();
    }
    folder
}

const OF_SIMULATION: [&str; 4] = ["--units", "mm-ms-kg", "--node", "rear sill"];

#[test]
fn a_wrong_order_is_refused_with_the_right_one() {
    let folder = records(&simulated::faulty_simulation().unwrap().test, &["H1"]);
    let folder = folder.path();
    // Without --validate a record is no run.
    let output = crumple(folder, &["compare", "crash.csv", "H1"]);
    assert!(output.status.code() == Some(2) && said(&output).contains("add --validate"), "{}", said(&output));
    let output = crumple(folder, &[&["compare", "H1", "crash.csv", "--validate"][..], &OF_SIMULATION].concat());
    let hint = "crumple compare ./runs/crash/default ./runs/H1/default --validate";
    assert!(output.status.code() == Some(2) && said(&output).contains(hint), "{}", said(&output));
    let [test, simulation] = ["runs/crash/default", "runs/H1/default"];
    for (order, expected) in [
        (vec![test, simulation, "crash.csv"], "stands in front of a test"),
        (vec![simulation, simulation], "none is a test"),
    ] {
        let output = crumple(folder, &[&["compare"], &order[..], &["--validate"]].concat());
        assert!(output.status.code() == Some(2) && said(&output).contains(expected), "{}", said(&output));
    }
}

#[test]
fn a_pulse_of_the_engine_is_not_compared_and_what_is_missing_is_named() {
    let set = simulated::faulty_simulation().unwrap();
    let folder = records(&set.test.replace("accel (", "engine accel ("), &["H1"]);
    let words = ["compare", "crash.csv", "H1", "--validate", "--json=v.json", "--require", "crush<=20m"];
    let output = crumple(folder.path(), &[&words[..], &OF_SIMULATION].concat());
    let text = said(&output);
    assert!(output.status.code() == Some(1) && text.contains("crush is not known, so that it does not hold"), "{text}");
    let found = json(folder.path());
    let first = found["sentences"][0].as_str().unwrap();
    assert!(first.starts_with("Not compared: in ") && first.contains("it sits elsewhere (engine)"), "{found}");
    assert!(found["sentences"].as_array().unwrap().len() == 2 && found["differences"][0].is_null(), "{found}");
    let output = crumple(folder.path(), &[&words[..5], &OF_SIMULATION].concat());
    assert_eq!(output.status.code(), Some(4), "{}", said(&output));
    // Mass and speed of the simulation are a hint where the test states none.
    let bare: String = set.test.lines().filter(|line| !line.starts_with('#')).map(|line| format!("{line}\n")).collect();
    let folder = records(&bare, &["H1"]);
    let output = crumple(folder.path(), &[&words[..4], &OF_SIMULATION].concat());
    let hint = "add --mass 1240kg --impact-speed 14m/s";
    assert!(output.status.code() == Some(4) && said(&output).contains(hint), "{}", said(&output));
}

#[test]
fn several_simulations_have_a_headline_each() {
    let folder = records(&simulated::faulty_simulation().unwrap().test, &["H1", "H2"]);
    let words = ["compare", "crash.csv", "H1", "H2", "--validate", "-o", "v.html", "--markdown", "v.md"];
    let output = crumple(folder.path(), &[&words[..], &OF_SIMULATION].concat());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let [page, markdown] = ["v.html", "v.md"].map(|name| fs::read_to_string(folder.path().join(name)).unwrap());
    assert_eq!(page.matches("<section class=\"verdict\"").count(), 2);
    for name in ["H1", "H2"] {
        assert!(markdown.contains(&format!("**{name}: The simulation is softer")), "{markdown}");
    }
    assert_eq!(markdown.matches("\n- Its front is too soft").count(), 2, "{markdown}");
    // Each with its own flags.
    let output = crumple(folder.path(), &["compare", "crash.csv", "H1", "H2", "--validate", "--units", "mm-s-t"]);
    let text = said(&output);
    assert!(output.status.code() == Some(3) && text.contains("crumple run H2 --units SYSTEM --node ID"), "{text}");
}

#[test]
fn an_interval_too_wide_for_equal_decides_nothing() {
    let Some(set) = shared("reference/simulation/s2-middle-of-the-front-too-stiff") else { return };
    let folder = tempfile::tempdir().unwrap();
    let [test, simulation] = ["test.csv", ""].map(|name| set.join(name).display().to_string());
    let of_test = ["--mass", "1500kg", "--impact-speed", "56km/h"];
    let flags = ["--units", "mm-s-t", "--node", "1000001", "--json=v.json"];
    let words = ["compare", &test, &simulation, "--validate"];
    let output = crumple(folder.path(), &[&words[..], &of_test, &flags].concat());
    let text = said(&output);
    assert!(text.starts_with("Undecided: the 90 % interval of the difference is"), "{text}");
    assert!(text.contains("add --time-zero 0s"), "{text}");
    assert_eq!(json(folder.path())["decision"], "undecided");
    // What the sentence names decides.
    let output = crumple(folder.path(), &[&words[..], &of_test, &flags, &["--time-zero", "0s"]].concat());
    assert!(said(&output).starts_with("The simulation is stiffer than the test"), "{}", said(&output));
    assert_eq!(json(folder.path())["decision"], "stiffer");
    // The energies of several simulations are told apart.
    for name in ["H1", "H2"] {
        std::os::unix::fs::symlink(&set, folder.path().join(name)).unwrap();
    }
    let words = ["compare", &test, "H1", "H2", "--validate", "-o", "v.html"];
    let output = crumple(folder.path(), &[&words[..], &of_test, &flags].concat());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let page = fs::read_to_string(folder.path().join("v.html")).unwrap();
    assert!(page.contains("H1, hourglass") && page.contains("H2, hourglass"));
}

/// The test of a set with its wall and engine, as one table.
fn test_of(set: &Path) -> String {
    let [felt, more] = ["test.csv", "test-wall-and-engine.csv"].map(|name| fs::read_to_string(set.join(name)).unwrap());
    let row = |(a, b): (&str, &str)| format!("{a},{}\n", b.split_once(',').unwrap().1);
    felt.lines().zip(more.lines()).map(row).collect()
}

#[test]
fn the_sets_of_the_reference_come_out() {
    /// A set, the file in it, flags of the simulation, the difference of crush in m, exit code, a part of the second
    /// sentence.
    type Case = (&'static str, &'static str, &'static [&'static str], f64, i32, &'static str);
    let Some(sets) = shared("reference/simulation") else { return };
    let folder = tempfile::tempdir().unwrap();
    let cases: [Case; 3] = [
        ("s1-same-car", "", &["--units", "mm-ms-kg"], 0.0, 0, "No segment of 100 mm differs by more than 5 %"),
        (
            "s2-middle-of-the-front-too-stiff",
            "",
            &["--units", "mm-s-t"],
            -0.0625,
            1,
            "Its front is too stiff from 100 to 500 mm",
        ),
        (
            "s3-openradioss-engine-mount-too-soft",
            "/CART01",
            &[],
            0.0642,
            1,
            "It is too soft between engine and compartment, not in the front",
        ),
    ];
    for (set, file, flags, crush_m, code, place) in cases {
        fs::write(folder.path().join("test.csv"), test_of(&sets.join(set))).unwrap();
        let simulation = format!("{}{file}", sets.join(set).display());
        let of_test = ["--mass", "1500kg", "--impact-speed", "15.65m/s", "--time-zero", "0s"];
        let words = ["compare", "test.csv", &simulation, "--validate", "--json=v.json", "--require", "crush<=20mm"];
        let pulse = ["--node", "1000001", "--channel", "acceleration"];
        let output = crumple(folder.path(), &[&words[..], &of_test, &pulse, flags].concat());
        assert_eq!(output.status.code(), Some(code), "{set}: {}", said(&output));
        let found = json(folder.path());
        let difference =
            found["differences"].as_array().unwrap().iter().find(|d| d["name"] == "dynamic_crush").unwrap();
        let [low, high] = ["low", "high"].map(|end| difference[end].as_f64().unwrap());
        assert!((low..=high).contains(&crush_m), "{set}: {difference}");
        let second = found["sentences"][1].as_str().unwrap().replace('\u{a0}', " ");
        assert!(second.contains(place), "{set}: {second}");
    }
}

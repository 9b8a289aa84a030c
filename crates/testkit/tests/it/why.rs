//! `crumple diff A B --why`: causes are named, and their shares add up to the change.

use std::path::Path;
use std::process::Command;

use crumple_testkit::programs::binary;
use crumple_testkit::workspace;
use serde_json::Value;

/// Flags of the second run, and what its change is divided among. The first has none of them.
const PAIRS: [(&[&str], &[&str]); 18] = [
    (&["--mass", "1500kg"], &["test.mass_kg"]),
    (&["--impact-speed", "58km/h"], &["test.impact_speed_m_per_s"]),
    (&["--set", "ingest.impact_speed=58 km/h"], &["test.impact_speed_m_per_s"]),
    (&["--time-zero=2ms"], &["test.time_zero_s"]),
    (&["--set", "filter.cfc=180"], &["filter.cfc"]),
    (&["--set", "filter.cfc=1000"], &["filter.cfc"]),
    (&["--set", "predict.speeds=40 km/h,50 km/h"], &["predict.speeds"]),
    (&["--stage", "filter=python3 OWN filter:wide"], &["program of filter"]),
    // Two to four changes.
    (&["--mass", "1500kg", "--impact-speed", "58km/h"], &["test.impact_speed_m_per_s", "test.mass_kg"]),
    (&["--mass", "1500kg", "--set", "filter.cfc=180"], &["test.mass_kg", "filter.cfc"]),
    (&["--impact-speed=50km/h", "--time-zero=2ms"], &["test.impact_speed_m_per_s", "test.time_zero_s"]),
    (&["--set", "filter.cfc=600", "--set", "integrate.rule=simpson"], &["filter.cfc", "integrate.rule"]),
    (&["--stage", "filter=python3 OWN filter:wide", "--mass=1300kg"], &["test.mass_kg", "program of filter"]),
    (
        &["--mass=1500kg", "--impact-speed=58km/h", "--set", "filter.cfc=180"],
        &["test.impact_speed_m_per_s", "test.mass_kg", "filter.cfc"],
    ),
    (
        &["--mass=1500kg", "--time-zero=1ms", "--set", "predict.speeds=40 km/h"],
        &["test.mass_kg", "test.time_zero_s", "predict.speeds"],
    ),
    (
        &["--mass=1500kg", "--set", "filter.cfc=180", "--set", "integrate.speed_uncertainty=1 km/h uniform"],
        &["test.mass_kg", "filter.cfc", "integrate.speed_uncertainty"],
    ),
    (
        &["--mass=1500kg", "--impact-speed=58km/h", "--time-zero=1ms", "--set", "filter.cfc=180"],
        &["test.impact_speed_m_per_s", "test.mass_kg", "test.time_zero_s", "filter.cfc"],
    ),
    // More than four come together by their stages.
    (
        &[
            "--mass=1500kg",
            "--impact-speed=58km/h",
            "--time-zero=1ms",
            "--set=filter.cfc=180",
            "--set=integrate.rule=simpson",
        ],
        &["test.impact_speed_m_per_s", "test.mass_kg, test.time_zero_s", "filter.cfc", "integrate.rule"],
    ),
];

fn crumple(folder: &Path, words: &[&str]) -> (i32, String, String) {
    let programs = binary("crumple").parent().unwrap().to_owned();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::env::join_paths(std::iter::once(programs.clone()).chain(std::env::split_paths(&path))).unwrap();
    let ended =
        Command::new(programs.join("crumple")).args(words).current_dir(folder).env("PATH", paths).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (ended.status.code().unwrap_or(-1), text(&ended.stdout), text(&ended.stderr))
}

/// Runs a record into `runs/NAME/default` with models that are quick to fit.
fn run(folder: &Path, name: &str, record: &str, flags: &[&str]) {
    let script = workspace().join("crates/testkit/tests/it/swapped_stages.py");
    let flags: Vec<String> = flags.iter().map(|flag| flag.replace("OWN", &script.display().to_string())).collect();
    let models = ["--set", "parameter-solve.models=kelvin,elastoplastic", "-q", "-o"];
    let words = ["run", record].into_iter().chain(flags.iter().map(String::as_str)).chain(models).chain([name]);
    let (code, _, said) = crumple(folder, &words.collect::<Vec<_>>());
    assert_eq!(code, 0, "{flags:?}: {said}");
}

fn why(folder: &Path, a: &str, b: &str) -> Value {
    let (code, json, said) = crumple(folder, &["diff", a, b, "--why", "--json"]);
    assert_eq!(code, 1, "{b}: {said}");
    let value: Value = serde_json::from_str(&json).unwrap();
    value["why"].clone()
}

/// What is wrong with the division of a change.
fn fault(divided: &Value, causes: &[&str]) -> Option<String> {
    let named: Vec<&str> = divided["causes"].as_array()?.iter().filter_map(Value::as_str).collect();
    if named != causes {
        return Some(format!("causes {named:?}"));
    }
    let numbers = divided["numbers"].as_array()?;
    // Shares are sums of 2^4 differences of numbers that are as large as their ends.
    let adds_up = |number: &Value| {
        let [from, to] = ["from", "to"].map(|end| number[end].as_f64().unwrap());
        let sum: f64 = number["shares"].as_array().unwrap().iter().map(|share| share.as_f64().unwrap()).sum();
        (sum - (to - from)).abs() <= 64.0 * f64::EPSILON * from.abs().max(to.abs())
    };
    let wrong = numbers.iter().find(|number| !adds_up(number)).map(|number| format!("does not add up: {number}"));
    // Other speeds are other numbers: none of both runs changes.
    let is_empty = numbers.is_empty() && causes != ["predict.speeds"];
    wrong.or_else(|| is_empty.then(|| "no number".to_owned()))
}

#[test]
fn causes_are_named_and_their_shares_add_up_to_the_change() {
    use rayon::prelude::*;
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(workspace().join("fixtures/elastoplastic/crash.csv"), folder.path().join("crash.csv")).unwrap();
    run(folder.path(), "a", "crash.csv", &[]);
    let faults: Vec<String> = PAIRS
        .par_iter()
        .enumerate()
        .filter_map(|(k, (flags, causes))| {
            let name = format!("b{k}");
            run(folder.path(), &name, "crash.csv", flags);
            fault(&why(folder.path(), "a", &name), causes).map(|fault| format!("{flags:?}: {fault}"))
        })
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn another_record_is_a_cause_and_a_record_that_is_gone_is_said() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["elastoplastic", "noisy"] {
        let copy = folder.path().join(format!("{name}.csv"));
        std::fs::copy(workspace().join("fixtures").join(name).join("crash.csv"), copy).unwrap();
    }
    run(folder.path(), "a", "elastoplastic.csv", &[]);
    run(folder.path(), "b", "noisy.csv", &["--set", "filter.cfc=180"]);
    assert_eq!(fault(&why(folder.path(), "a", "b"), &["record", "filter.cfc"]), None);
    std::fs::remove_file(folder.path().join("noisy.csv")).unwrap();
    let (code, _, said) = crumple(folder.path(), &["diff", "a", "b", "--why"]);
    assert!(code == 2 && said.contains("the record \"noisy.csv\" is not at hand"), "{code} {said}");
    let looked_for = folder.path().canonicalize().unwrap().join("noisy.csv");
    assert!(said.contains(&format!("looked for {}", looked_for.display())), "{said}");
    assert!(said.contains("put the record there and type crumple diff a b --why"), "{said}");
}

//! Reference cases of prediction: the product is fed, every number of a case is compared, nothing is computed here.
//!
//! `CRUMPLE_PREDICTION_CASES` names another case file of the same form. One file a kind; a new kind is a line of
//! [`KINDS`].

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod compare;
mod element_path;
mod extraction;
mod fields;
mod impact;
mod model;
mod occupant;
mod partners;
mod practice;
mod sensitivity;

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::Value;

use crate::fields::Fields;

/// What the product says to the inputs of a case, in the names of the case file.
type Answer = fn(&Fields) -> Result<Value, String>;

/// The kinds of cases.
const KINDS: &[(&str, Answer)] = &[
    ("impact", impact::answer),
    ("element-path", element_path::answer),
    ("partners", partners::answer),
    ("occupant", occupant::answer),
    ("sensitivity", sensitivity::answer),
    ("extraction", extraction::of_one_test),
    ("joint-fit", extraction::of_several_tests),
    ("quadratic-program", extraction::of_a_program),
    ("kw400", practice::of_wall),
    ("crash3", practice::of_damage),
];

fn main() -> ExitCode {
    if crumple_testkit::asked_for_tests("prediction") {
        return ExitCode::SUCCESS;
    }
    let Some(cases) = cases() else { return ExitCode::SUCCESS };
    let mut met = 0;
    let mut all = 0;
    for case in &cases {
        let (id, kind) = (case["id"].as_str().unwrap_or("?"), case["kind"].as_str().unwrap_or("?"));
        all += 1;
        match check(case, kind) {
            Ok(()) => met += 1,
            Err(fault) => println!("FAILED {id} ({kind}): {fault}"),
        }
    }
    println!("{met} of {all} cases");
    if met == all && all > 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The cases of the file; `None` where there is no such file, which is said.
fn cases() -> Option<Vec<Value>> {
    let given = std::env::var_os("CRUMPLE_PREDICTION_CASES").map(PathBuf::from);
    let path = given.or_else(|| crumple_testkit::shared("reference/prediction.json"))?;
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let file: Value = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    Some(file["cases"].as_array().or_else(|| file.as_array()).cloned().unwrap_or_default())
}

/// Whether a case is met; else what is not.
fn check(case: &Value, kind: &str) -> Result<(), String> {
    let Some((_, answer)) = KINDS.iter().find(|(name, _)| *name == kind) else {
        return Err("no such kind".to_owned());
    };
    let inputs = Fields::of(&case["inputs"], "inputs")?;
    let found = answer(&inputs)?;
    inputs.all_read()?;
    let tolerance = |name: &str| case["tolerance"][name].as_f64().ok_or(format!("tolerance {name}"));
    let tolerance = compare::Tolerance { relative: tolerance("rel")?, absolute: tolerance("abs")? };
    compare::values(&case["expected"], &found["expected"], "", tolerance)?;
    match case.get("events") {
        Some(events) => compare::events(events, &found["events"], tolerance),
        None => Ok(()),
    }
}

//! Prediction: impacts, partners, occupants, extraction and the rules of practice. One file a kind; a new kind is a
//! line of [`KINDS`].

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

use serde_json::Value;

use crate::prediction::fields::Fields;

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

pub fn check(_: Value) -> crate::Check {
    Box::new(|case| met(case).err().into_iter().collect())
}

/// Whether a case is met; else what is not.
fn met(case: &Value) -> Result<(), String> {
    let kind = case["kind"].as_str().unwrap_or("?");
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

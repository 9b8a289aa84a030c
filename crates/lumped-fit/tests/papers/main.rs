//! Every number of the three papers: recomputed here, compared with reference values of fifty digits, and shown on
//! `docs/papers.md`.
//!
//! `CRUMPLE_PAPER_CASES` names another case file of the same form. `CRUMPLE_WRITE_PAPERS=1` writes the page anew.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod chains;
mod compare;
mod evaluate;
mod inputs;
mod one_mass;
mod page;
mod systems;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::Value;

fn main() -> ExitCode {
    if crumple_testkit::asked_for_tests("papers") {
        return ExitCode::SUCCESS;
    }
    let page_agrees = check_page();
    let variants_agree = check_variants();
    let (right, all) = check_cases(&cases().unwrap_or_default());
    println!("{right} of {all} items");
    let ticks_agree = check_ticks();
    if page_agrees && variants_agree && ticks_agree && right == all { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Whether the committed page is what the table and the libraries give.
fn check_page() -> bool {
    let path = crumple_testkit::workspace().join("docs/papers.md");
    let made = page::page().unwrap_or_else(|error| panic!("the table of printed values: {error}"));
    if std::env::var_os("CRUMPLE_WRITE_PAPERS").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    if committed == made {
        println!("docs/papers.md is up to date");
        return true;
    }
    let differs = committed.lines().zip(made.lines()).position(|(a, b)| a != b).unwrap_or(0);
    println!("docs/papers.md differs from what `just papers` writes, first in line {}:", differs + 1);
    println!("  committed: {}", committed.lines().nth(differs).unwrap_or(""));
    println!("  made:      {}", made.lines().nth(differs).unwrap_or(""));
    false
}

/// The items of the case file, none where there is no such file.
fn cases() -> Option<Vec<Value>> {
    let given = std::env::var_os("CRUMPLE_PAPER_CASES").map(PathBuf::from);
    let path = given.or_else(|| crumple_testkit::shared("reference/papers.json"))?;
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let file: Value = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    Some(file["items"].as_array().or_else(|| file.as_array()).cloned().unwrap_or_default())
}

/// Whether the page ticks the printed values that the case file says agree. Compared are the sorted pairs of printed
/// value and tick of an item: lists without an order of their own are numbered differently there.
fn check_ticks() -> bool {
    let shown = page::shown().unwrap();
    let mut same = true;
    for item in cases().unwrap_or_default() {
        let (Some(id), Some(printed)) = (item["id"].as_str(), item["printed"].as_object()) else { continue };
        let Some(page::Shown { ticks, not_printed }) = shown.get(id) else { continue };
        let mut wanted: page::Ticks = printed
            .iter()
            .filter(|(name, _)| !not_printed.contains(name))
            .map(|(_, value)| (value["printed"].as_str().unwrap().to_owned(), value["agrees"].as_bool().unwrap()))
            .collect();
        wanted.sort();
        if *ticks != wanted {
            same = false;
            println!("FAILED {id}: the page ticks {ticks:?}, the case file {wanted:?}");
        }
    }
    same
}

/// Whether the same kinds with other numbers are met: three masses, other masses and root configurations, multiple
/// roots. Made by `variants.py`.
fn check_variants() -> bool {
    let file: Value = serde_json::from_str(include_str!("variants.json")).unwrap();
    let items = file["items"].as_array().unwrap();
    let (right, all) = check_cases(items);
    println!("variants: {right} of {all}");
    right == all
}

/// Cases met and cases there are.
fn check_cases(items: &[Value]) -> (usize, usize) {
    let mut kinds: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for item in items {
        let name = |key: &str| item[key].as_str().unwrap_or("?").to_owned();
        let kind = name("kind");
        let tolerance = item["tolerance_to_recomputed_relative"].as_f64().unwrap_or(1e-9);
        let mut inputs = compare::plain(&item["inputs"]);
        // The instants are part of what is expected, not of the model.
        if let Some(list) = item["expected"]["checkpoints"].as_array() {
            let times: Vec<Value> = list.iter().map(|point| compare::plain(&point["t"])).collect();
            inputs[inputs::CHECKPOINT_TIMES] = Value::Array(times);
        }
        let fault = match evaluate::evaluate(&kind, &inputs) {
            Ok(found) => compare::difference(&compare::plain(&item["expected"]), &found, tolerance),
            Err(error) => Some(error),
        };
        let count = kinds.entry(kind.clone()).or_default();
        count.1 += 1;
        match fault {
            None => count.0 += 1,
            Some(fault) => println!("FAILED {} ({kind}) {fault}", name("id")),
        }
    }
    for (kind, (right, all)) in &kinds {
        println!("{kind}: {right} of {all}");
    }
    kinds.values().fold((0, 0), |(a, b), (right, all)| (a + right, b + all))
}

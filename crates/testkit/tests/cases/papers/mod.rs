//! Every number of the three papers: recomputed here, compared with reference values of fifty digits, and shown on
//! `docs/papers.md`. `CRUMPLE_WRITE_PAPERS=1` writes the page.

mod chains;
mod compare;
mod page;
mod systems;

use serde_json::Value;

use crate::{all_met, cases_of, read};

/// Whether the committed page is what is computed, ticks what the case file says agrees, and the same kinds with other
/// numbers are met.
pub fn page_and_variants_agree() -> bool {
    let (page_agrees, ticks_agree) = (check_page(), check_ticks());
    println!("variants (three masses, other masses and root configurations, multiple roots; made by `variants.py`):");
    let variants = serde_json::from_str(include_str!("variants.json")).unwrap();
    all_met(&variants, None, check) && page_agrees && ticks_agree
}

pub fn check(_: Value) -> crate::Check {
    Box::new(|case| difference(case).into_iter().collect())
}

/// What differs first.
fn difference(case: &Value) -> Option<String> {
    let tolerance = case["tolerance_to_recomputed_relative"].as_f64().unwrap_or(1e-9);
    let mut inputs = compare::plain(&case["inputs"]);
    // The instants are part of what is expected, not of the model.
    if let Some(list) = case["expected"]["checkpoints"].as_array() {
        let times: Vec<Value> = list.iter().map(|point| compare::plain(&point["t"])).collect();
        inputs[systems::CHECKPOINT_TIMES] = Value::Array(times);
    }
    match systems::evaluate(case["kind"].as_str().unwrap_or("?"), &inputs) {
        Ok(found) => compare::difference(&compare::plain(&case["expected"]), &found, tolerance),
        Err(error) => Some(error),
    }
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

/// Whether the page ticks the printed values that the case file says agree. Compared are the sorted pairs of printed
/// value and tick of an item: lists without an order of their own are numbered differently there.
fn check_ticks() -> bool {
    let shown = page::shown().unwrap();
    let Some(path) = crumple_testkit::shared("reference/papers.json") else { return true };
    let mut same = true;
    for item in cases_of(&read(&path)) {
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

//! Reference cases: the product is fed with the inputs of a case file and every expected number is compared; nothing is
//! computed here. `just cases identification|metrics|papers|prediction|records|reviews [FILE]`; as a test, every kind
//! over its shared file.
//!
//! Prints a count for each kind of case, what failed, and last `N of M cases`. A kind of case that is not known here
//! fails by its name.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod expected;
mod identification;
mod metrics;
mod papers;
mod prediction;
mod records;
mod reviews;

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::Value;

/// What of a case is not met; empty: all of it is.
type Check = Box<dyn Fn(&Value) -> Vec<String>>;

/// A subject: its name, its shared file, and what checks a case of such a file.
type Subject = (&'static str, &'static str, fn(Value) -> Check);

const SUBJECTS: [Subject; 6] = [
    ("identification", "reference/identification-cases.json", identification::check),
    ("metrics", "reference/metrics.json", metrics::check),
    ("papers", "reference/papers.json", papers::check),
    ("prediction", "reference/prediction.json", prediction::check),
    ("records", "reference/cases/cases.json", records::check),
    ("reviews", "reference/cases/cases-t4.json", reviews::check),
];

/// The kinds of a file that are of its subject; all of them where a subject states none.
const KINDS: [(&str, &[&str]); 1] = [("reviews", &["T4-f02", "T4-f06"])];

fn main() -> ExitCode {
    if crumple_testkit::programs::asked_for_tests("cases") {
        return ExitCode::SUCCESS;
    }
    let words: Vec<String> = std::env::args().skip(1).collect();
    let asked = words.first().filter(|word| SUBJECTS.iter().any(|(name, ..)| name == word));
    let mut is_right = true;
    for (name, shared, check) in SUBJECTS.iter().filter(|(name, ..)| asked.is_none_or(|asked| asked == name)) {
        let given = asked.and(words.get(1)).map(PathBuf::from);
        // What the project itself holds of the papers needs no shared file.
        is_right &= *name != "papers" || given.is_some() || papers::page_and_variants_agree();
        if let Some(path) = given.or_else(|| crumple_testkit::shared(shared)) {
            let kinds = KINDS.iter().find(|(subject, _)| subject == name).map(|(_, kinds)| *kinds);
            is_right &= all_met(&read(&path), kinds, *check);
        }
    }
    if is_right { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn read(path: &Path) -> Value {
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut file: Value = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    // Records lie beside the file of their cases.
    if let Some(file) = file.as_object_mut() {
        let folder = path.canonicalize().ok().and_then(|path| path.parent().map(Path::to_owned)).unwrap_or_default();
        file.insert("folder".to_owned(), Value::from(folder.to_string_lossy()));
    }
    file
}

/// The cases of a file: its list `cases` or `items`, or the file itself.
fn cases_of(file: &Value) -> &[Value] {
    let named = file["cases"].as_array().or_else(|| file["items"].as_array());
    named.or_else(|| file.as_array()).map_or(&[], Vec::as_slice)
}

/// Checks every case of a file, says what is not met and how many are.
fn all_met(file: &Value, kinds: Option<&[&str]>, check: fn(Value) -> Check) -> bool {
    let check = check(file.clone());
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for case in cases_of(file) {
        let kind = case["kind"].as_str().or_else(|| case["metric"].as_str()).unwrap_or("(no kind)");
        if kinds.is_some_and(|kinds| !kinds.contains(&kind)) {
            continue;
        }
        let (met, all) = counts.entry(kind).or_default();
        *all += 1;
        // A case of another shape panics; the others still count.
        let failures = catch_unwind(AssertUnwindSafe(|| check(case))).unwrap_or_else(|panic| {
            let message = panic.downcast_ref::<String>().cloned();
            vec![message.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned())).unwrap_or_default()]
        });
        *met += usize::from(failures.is_empty());
        let id = case["id"].as_str().unwrap_or("?");
        failures.iter().for_each(|failure| println!("FAILED {id} ({kind}): {failure}"));
    }
    for (kind, (met, all)) in &counts {
        println!("{kind}: {met} of {all}");
    }
    let (met, all) = counts.values().fold((0, 0), |(m, a), (met, all)| (m + met, a + all));
    println!("{met} of {all} cases");
    met == all && all > 0
}

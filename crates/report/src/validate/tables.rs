//! The comparison of simulations with a test as tables, JSON and cases of JUnit.

use crumple_signal::display::unit_shown;
use crumple_signal::key_quantities::KeyQuantity;
use serde_json::{Value, json};

use super::checks::{Check, Outcome};
use super::requirements::{Requirement, shown};
use super::segments::Segment;
use super::validation::{Side, Validation};
use super::verdict::Difference;
use crate::ComparedRun;
use crate::compare::document::{RATING, Section};
use crate::compare::numbers::row;
use crate::compare::quantities::{Group, engineering, quantities};
use crate::compare::review_files::{Case, Suite};
use crate::compare::table::{Cell, Row};
use crate::drawing::numbers::{ABSENT, KILO, MILLI};
use crate::findings::capitalised;
use crate::words;

/// A column a simulation: `text` finds the row of one in it.
fn rows(names: &[String], all: &[Validation], cell: impl Fn(&Validation, &str) -> Option<Cell>) -> Vec<Row> {
    let none = || Cell { text: ABSENT.to_owned(), ..Cell::default() };
    let row = |name: &String| Row {
        name: name.clone(),
        cells: all.iter().map(|one| cell(one, name).unwrap_or_else(none)).collect(),
    };
    names.iter().map(row).collect()
}

/// Names of the rows of all, each once, in the order of the first that has them.
fn names(all: &[Validation], of_one: impl Fn(&Validation) -> Vec<String>) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for name in all.iter().flat_map(of_one) {
        if !found.contains(&name) {
            found.push(name);
        }
    }
    found
}

/// The tables, each with a column a simulation; parameters beside those of the test.
pub fn sections(pairs: &[(&Side<'_>, &Side<'_>)], all: &[Validation]) -> Vec<Section> {
    let columns: Vec<String> = all.iter().map(|one| one.name.clone()).collect();
    let section = |heading: &str, of: &'static str, rows: Vec<Row>| Section {
        heading: heading.to_owned(),
        of,
        columns: columns.clone(),
        rows,
    };
    let mut sections = vec![section("Key numbers, simulation less test", "Difference", differences(all))];
    let of_segments = [
        ("Wall force over the test's, by crush", 0),
        ("Wall force over the test's, by travel of the engine", 1),
        ("Deceleration over the test's, by crush", 2),
    ];
    sections.extend(of_segments.map(|(heading, k)| section(heading, "Segment", by_segment(all, k))));
    sections.push(section("Ratings, the test as reference", RATING, ratings(all)));
    for ((test, simulation), one) in pairs.iter().zip(all) {
        if let Some(family) = &one.family {
            sections.push(parameters([test.run, simulation.run], family));
        }
    }
    sections.push(section("Quality of the simulation", "Check", checks(all)));
    sections.push(section("Required", "Requirement", required(all)));
    let text = |one: &Validation, name: &str| {
        let found = one.assumed.iter().find(|(own, _)| own == name)?;
        Some(Cell { text: found.1.clone(), ..Cell::default() })
    };
    let of_assumed = names(all, |one| one.assumed.iter().map(|(name, _)| name.clone()).collect());
    sections.push(section("What was assumed", "Of", rows(&of_assumed, all, text)));
    sections
}

fn differences(all: &[Validation]) -> Vec<Row> {
    let title = |key: &str| KeyQuantity::of(key).map_or_else(String::new, |quantity| quantity.title.to_owned());
    let cell = |one: &Validation, name: &str| {
        let found = one.differences.iter().find(|difference| title(&difference.name) == name)?;
        let (factor, places, unit) = KeyQuantity::of(&found.name)?.shown();
        let ends = found.low.zip(found.high).map(|(low, high)| {
            let [low, high] = [low, high].map(|end| words::signed_cell(factor * end, places, unit));
            format!("90\u{a0}%: {}", words::between(&low, &high))
        });
        let text = words::deviation(factor * found.difference, places, unit);
        let [own, of_test] = [found.simulation, found.test].map(|x| words::decimals(factor * x, places));
        let both = words::with_unit(format!("{own} for {of_test}"), unit);
        let beside = ends.map_or_else(|| both.clone(), |ends| format!("{both}; {ends}"));
        Some(Cell { text, beside, differs: found.is_apart() })
    };
    rows(&names(all, |one| one.differences.iter().map(|one| title(&one.name)).collect()), all, cell)
}

/// Ratios by the wall over crush (0) and over the travel of the engine (1), by deceleration (2).
fn by_segment(all: &[Validation], which: usize) -> Vec<Row> {
    let of = |one: &Validation| [&one.wall, &one.front, &one.deceleration][which].clone();
    let name = |segment: &Segment| {
        let [from, to] = [segment.from_m, segment.to_m].map(|x| words::cell(MILLI * x, 0, "mm"));
        words::with_unit(words::between(&from, &to), unit_shown("mm"))
    };
    let cell = |one: &Validation, wanted: &str| {
        let segment = of(one).into_iter().find(|segment| name(segment) == wanted)?;
        let two = |x: f64| words::decimals(x, 2);
        let ends = segment.low.zip(segment.high);
        let ends = ends.map_or_else(|| "open".to_owned(), |(low, high)| words::between(&two(low), &two(high)));
        let [test, simulation] = [segment.test_n, segment.simulation_n].map(|x| words::cell(KILO * x, 0, "kN"));
        let text = segment.ratio.map_or_else(|| ABSENT.to_owned(), two);
        let beside = format!("90\u{a0}%: {ends}; {simulation} of {test} {}", unit_shown("kN"));
        Some(Cell { text, beside, differs: segment.is_named() })
    };
    rows(&names(all, |one| of(one).iter().map(name).collect()), all, cell)
}

fn ratings(all: &[Validation]) -> Vec<Row> {
    let parts = |one: &Validation| -> Vec<(String, String)> {
        let of_one = |rating: &super::ratings::Rating| {
            let named = |part: &str| format!("{}, {part}", capitalised(rating.quantity));
            let score = |value: Option<f64>| value.map_or_else(|| ABSENT.to_owned(), |value| words::decimals(value, 3));
            let grade = rating.iso.grade.map_or_else(String::new, |grade| format!(", {}", grade.name()));
            let with_grade = |(k, (part, value)): (usize, (&str, Option<f64>))| {
                (named(part), score(value) + if k == 0 { &grade } else { "" })
            };
            let shift = words::deviation(MILLI * rating.shift_s(), 1, "ms");
            let (from_s, to_s) = rating.iso.interval_s;
            let scores: Vec<(String, String)> = rating.parts().into_iter().enumerate().map(with_grade).collect();
            let window = [(named("shift"), shift), (named("window"), words::times(from_s, to_s))];
            scores.into_iter().chain(window).collect::<Vec<_>>()
        };
        one.ratings.iter().flat_map(of_one).collect()
    };
    let cell = |one: &Validation, name: &str| {
        let (_, text) = parts(one).into_iter().find(|(own, _)| own == name)?;
        Some(Cell { text, ..Cell::default() })
    };
    rows(&names(all, |one| parts(one).into_iter().map(|(name, _)| name).collect()), all, cell)
}

/// The parameters of one family in both runs, as a comparison of runs has those of the recommended models.
fn parameters(runs: [&ComparedRun; 2], ids: &[String; 2]) -> Section {
    let summary = |k: usize| {
        let mut summary = runs[k].summary.clone();
        summary.recommended = Some(ids[k].clone());
        summary
    };
    let (a, b) = (summary(0), summary(1));
    let all = quantities(&[&a, &b], &engineering());
    Section {
        heading: format!("Parameters of one family: {}", runs[1].run.name_of(&ids[1])),
        of: "Parameter",
        columns: runs.iter().map(|run| run.name.clone()).collect(),
        rows: all.iter().filter(|quantity| quantity.group == Group::Parameter).map(row).collect(),
    }
}

fn checks(all: &[Validation]) -> Vec<Row> {
    let name = |check: &Check| format!("{}: {} ({})", capitalised(check.what), check.limit(), check.source);
    let cell = |one: &Validation, wanted: &str| {
        let check = one.verdict.checks.iter().find(|check| name(check) == wanted)?;
        let value = check.value.map(|value| shown(check.name, value));
        let text = value.map_or_else(String::new, |value| format!("{value}, ")) + check.outcome.word();
        Some(Cell { text, differs: check.outcome == Outcome::Failed, ..Cell::default() })
    };
    rows(&names(all, |one| one.verdict.checks.iter().map(name).collect()), all, cell)
}

/// A value that was required, in words; `None`: it holds.
fn broken(one: &Validation, text: &str) -> Option<String> {
    let (requirement, value) = one.broken().find(|(requirement, _)| requirement.text == text)?;
    Some(match value {
        Some(value) => format!("{}: {} is {}", one.name, requirement.name, shown(requirement.name, *value)),
        None => format!("{}: {} is not known, so that it does not hold", one.name, requirement.name),
    })
}

/// What does not hold, a line each.
pub fn broken_lines(all: &[Validation]) -> Vec<String> {
    let of_one = |one: &Validation| {
        let texts: Vec<&str> = one.required.iter().map(|(requirement, _)| requirement.text.as_str()).collect();
        let line = |text: &str| Some(format!("{}, required {text}", broken(one, text)?));
        texts.into_iter().filter_map(line).collect::<Vec<_>>()
    };
    all.iter().flat_map(of_one).collect()
}

fn required(all: &[Validation]) -> Vec<Row> {
    let cell = |one: &Validation, name: &str| {
        let (requirement, value) = one.required.iter().find(|(requirement, _)| requirement.text == name)?;
        let is_held = requirement.is_held(*value);
        let value = value.map_or_else(|| "not known".to_owned(), |value| shown(requirement.name, value));
        let text = format!("{value}, {}", if is_held { "held" } else { "not held" });
        Some(Cell { text, beside: requirement.source.clone(), differs: !is_held })
    };
    rows(&names(all, |one| one.required.iter().map(|(one, _)| one.text.clone()).collect()), all, cell)
}

/// The suites of JUnit: a case a requirement, and one each check of what is in the file and is not required.
pub fn suites(all: &[Validation]) -> Vec<Suite> {
    let required = |one: &Validation| -> Vec<Case> {
        let case = |(own, _): &(Requirement, Option<f64>)| {
            ("required", own.text.clone(), broken(one, &own.text).map(|problem| (false, problem)))
        };
        one.required.iter().map(case).collect()
    };
    let checked = |one: &Validation| -> Vec<Case> {
        let is_required = |check: &&Check| one.required.iter().any(|(own, _)| own.name == check.name);
        let known = one.verdict.checks.iter().filter(|check| check.value.is_some() && !is_required(check));
        let case = |check: &Check| {
            let value = check.value.map(|value| shown(check.name, value)).unwrap_or_default();
            let problem = format!("{} is {value}, limit {} ({})", check.what, check.limit(), check.source);
            let is_failed = check.outcome == Outcome::Failed;
            ("checks", check.name.to_owned(), is_failed.then_some((false, problem)))
        };
        known.map(case).collect()
    };
    let suite = |one: &Validation| Suite {
        name: one.name.clone(),
        cause: one.verdict.sentences().join(" "),
        error: "unknown",
        cases: [required(one), checked(one)].concat(),
    };
    all.iter().map(suite).collect()
}

/// All numbers, SI, for scripts.
pub fn to_json(all: &[Validation]) -> Value {
    let one = |one: &Validation| {
        let ratings = one.ratings.iter().map(|rating| {
            let parts: serde_json::Map<String, Value> =
                rating.parts().into_iter().map(|(name, value)| (name.to_owned(), json!(value))).collect();
            (rating.quantity.to_owned(), json!({"parts": parts, "shift_s": rating.shift_s()}))
        });
        let required: Vec<Value> = one
            .required
            .iter()
            .map(|(own, value)| json!({"requirement": own, "value": value, "held": own.is_held(*value)}))
            .collect();
        json!({
            "name": one.name,
            "test": one.test,
            "sentences": one.verdict.sentences(),
            "decision": one.verdict.crush.as_ref().map(Difference::decision),
            "verdict": one.verdict,
            "differences": one.differences,
            "segments": {"wall": one.wall, "engine": one.front, "deceleration": one.deceleration},
            "ratings": ratings.collect::<serde_json::Map<_, _>>(),
            "required": required,
            "assumed": one.assumed.iter().cloned().collect::<std::collections::BTreeMap<_, _>>(),
        })
    };
    json!({"schema": "crumple.validation.v1", "simulations": all.iter().map(one).collect::<Vec<_>>()})
}

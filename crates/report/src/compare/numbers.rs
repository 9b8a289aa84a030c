//! Key numbers and the recommended models of several runs, row by row, and where they differ from the first run.

use crate::phrases::PHRASES;
use crate::phrases::words;
use std::collections::BTreeSet;

use crate::drawing::numbers::{ABSENT, MILLI, digits_of_interval};
use crate::findings::{CandidateResult, KeyNumber, candidate_name, key_numbers, parameter, parameter_order};
use crate::phrases::words::fill;
use crumple_diff::{Base, CompareSettings, Tolerances, compare_json};
use serde::Serialize;

use super::compared_run::ComparedRun;
use super::table::{Cell, Row};
use crate::page::key_numbers::title;

/// The rows of the key numbers: every number that one of the runs has.
pub fn key_number_rows(runs: &[ComparedRun]) -> Vec<Row> {
    let numbers: Vec<Vec<KeyNumber>> = runs.iter().map(|run| key_numbers(&run.run)).collect();
    let places_apart: Vec<BTreeSet<String>> =
        numbers.iter().map(|other| places_that_differ("summary.json", &numbers[0], other)).collect();
    let names = in_order(numbers.iter().map(|of_run| of_run.iter().map(|number| &*number.name).collect()));
    let row = |name: &str| {
        let of_run = |k: usize| numbers[k].iter().find(|number| number.name == name);
        let first = of_run(0).and_then(|number| number.value);
        let cell = |k: usize| match of_run(k) {
            Some(number) => {
                let differs = places_apart[k].contains(&format!("[{name}].value"));
                number_cell(number, first, differs)
            }
            None => Cell { text: ABSENT.to_owned(), differs: first.is_some(), ..Cell::default() },
        };
        let titles = (0..runs.len()).filter(|k| of_run(*k).is_some()).map(|k| title(&runs[k].run, name));
        let titles: BTreeSet<String> = titles.collect();
        // A peak of runs that were filtered differently is a peak.
        let names: BTreeSet<&str> = titles.iter().filter_map(|title| title.split(", ").next()).collect();
        let name = if titles.len() == 1 { titles.into_iter().collect() } else { names.into_iter().collect() };
        Row { name, cells: (0..runs.len()).map(cell).collect() }
    };
    names.into_iter().map(row).collect()
}

fn number_cell(number: &KeyNumber, first: Option<f64>, differs: bool) -> Cell {
    let (factor, digits, unit) = number.quantity().shown();
    let shown = |value: f64| format!("{}{}", number.sign(), number.shown(value));
    let text = number.value.map_or_else(|| ABSENT.to_owned(), shown);
    let mut beside = Vec::new();
    if let (Some(value), Some(first), true) = (number.value, first, differs) {
        beside.push(words::deviation(factor * (value - first), digits + 1, unit));
    }
    if let (Some(low), Some(high)) = (number.low, number.high) {
        let [low, high] = [low, high].map(|end| words::decimals(factor * end, digits));
        beside.push(words::between(&low, &high));
    }
    Cell { text, beside: beside.join("; "), differs }
}

/// The rows of the recommended models: which, how well it follows, its parameters. Empty where no run has one.
pub fn model_rows(runs: &[ComparedRun]) -> Vec<Row> {
    let models: Vec<Option<&CandidateResult>> = runs.iter().map(ComparedRun::recommended).collect();
    if models.iter().all(Option::is_none) {
        return Vec::new();
    }
    let names = &PHRASES.runs;
    let texts = |text: &dyn Fn(&CandidateResult) -> Option<String>| -> Vec<String> {
        models.iter().map(|model| model.and_then(text).unwrap_or_else(|| ABSENT.to_owned())).collect()
    };
    let determined = |model: &CandidateResult| model.certainties().words();
    let mut rows = vec![
        Row::of_texts(names.recommended, &texts(&|model| Some(candidate_name(&model.id)))),
        Row::of_texts(names.certainty, &texts(&determined)),
        fit_row(&models),
    ];
    let places_apart: Vec<BTreeSet<String>> = models
        .iter()
        .map(|model| match (models[0], model) {
            (Some(first), Some(model)) => places_that_differ("/parameters/-", &first.record, &model.record),
            _ => BTreeSet::new(),
        })
        .collect();
    for name in in_order(models.iter().map(|model| model.map_or_else(Vec::new, parameter_names))) {
        let has = |model: &&CandidateResult| model.record.parameters.contains_key(name);
        let Some(model) = models.iter().flatten().find(|model| has(model)) else { continue };
        let (symbol, _, unit) = parameter(&model.record.model, name, 0.0);
        let cell = |k: usize| match models[k].filter(has) {
            Some(model) => {
                let first = models[0].and_then(|first| first.record.parameters.get(name));
                parameter_cell(model, name, first, places_apart[k].contains(&format!("parameters.{name}")))
            }
            None => Cell { text: ABSENT.to_owned(), ..Cell::default() },
        };
        let name = if unit.is_empty() { symbol } else { format!("{symbol}, {unit}") };
        rows.push(Row { name, cells: (0..runs.len()).map(cell).collect() });
    }
    rows
}

fn parameter_names(model: &CandidateResult) -> Vec<&str> {
    let mut names: Vec<&str> = model.record.parameters.keys().map(String::as_str).collect();
    names.sort_by_key(|name| parameter_order(&model.record.model, name));
    names
}

/// How closely the model follows the displacement; apart where two fits are not called equally good.
fn fit_row(models: &[Option<&CandidateResult>]) -> Row {
    let fits: Vec<Option<f64>> = models.iter().map(|model| model.and_then(CandidateResult::fit_percent)).collect();
    let apart = |fit: Option<f64>| {
        fit.zip(fits[0]).is_some_and(|(fit, first)| (fit - first).abs() > crate::findings::ranking::AS_GOOD_PERCENT)
    };
    let cell = |fit: &Option<f64>| Cell {
        text: fit.map_or_else(|| ABSENT.to_owned(), |fit| words::quantity(fit, 2, "%")),
        differs: apart(*fit),
        ..Cell::default()
    };
    Row { name: PHRASES.runs.displacement_fit.to_owned(), cells: fits.iter().map(cell).collect() }
}

fn parameter_cell(model: &CandidateResult, name: &str, first: Option<&f64>, differs: bool) -> Cell {
    let record = &model.record;
    let value = record.parameters[name];
    let shown = |value: f64| parameter(&record.model, name, value).1;
    let mut beside = Vec::new();
    if let Some(first) = first.filter(|first| differs && **first != 0.0) {
        beside.push(words::deviation(100.0 * (value - first) / first.abs(), 1, "%"));
    }
    let ends = record
        .uncertainty
        .as_ref()
        .and_then(|known| Some((known.interval_low.get(name).copied()?, known.interval_high.get(name).copied()?)));
    match (model.doubt(name), ends) {
        (Some(doubt), _) => beside.push(doubt.to_owned()),
        (None, Some((low, high))) => {
            let digits = low.zip(high).map_or(3, |(low, high)| digits_of_interval(low, high, 3));
            let open = PHRASES.model.open;
            let end = |end: Option<f64>| end.map_or_else(|| open.to_owned(), |x| words::significant(shown(x), digits));
            beside.push(words::between(&end(low), &end(high)));
        }
        (None, None) => {}
    }
    Cell { text: words::significant(shown(value), 4), beside: beside.join("; "), differs }
}

/// Predicted crush at the speeds that more than one run was predicted at, against the wall.
pub fn prediction_rows(runs: &[ComparedRun]) -> Vec<Row> {
    let of_run = |run: &ComparedRun| -> Vec<(u64, f64)> {
        let wall = run.run.predictions.iter().filter(|p| p.partner.is_none() && p.collision.is_none());
        let of_model = wall.filter(|p| Some(p.candidate.as_str()) == run.ranking.best.as_deref());
        of_model.filter_map(|p| Some((p.impact_speed_m_per_s.to_bits(), p.dynamic_crush_m?))).collect()
    };
    let crushes: Vec<Vec<(u64, f64)>> = runs.iter().map(of_run).collect();
    let count = |speed: u64| crushes.iter().filter(|of_run| of_run.iter().any(|(other, _)| *other == speed)).count();
    let mut speeds: Vec<u64> = crushes.iter().flatten().map(|(speed, _)| *speed).filter(|s| count(*s) > 1).collect();
    // Bits of positive numbers are in the order of the numbers.
    speeds.sort_unstable();
    speeds.dedup();
    let row = |speed: u64| {
        let crush = |k: usize| crushes[k].iter().find(|(other, _)| *other == speed).map(|(_, crush)| *crush);
        let cell = |k: usize| match crush(k) {
            Some(value) => {
                let apart = crush(0).map_or(0.0, |first| value - first);
                // What an engineer calls the same: 1 mm.
                let differs = apart.abs() > 1e-3;
                let beside = if differs { words::deviation(MILLI * apart, 1, "mm") } else { String::new() };
                Cell { text: words::quantity(MILLI * value, 1, "mm"), beside, differs }
            }
            None => Cell { text: ABSENT.to_owned(), ..Cell::default() },
        };
        let speed = words::quantity(3.6 * f64::from_bits(speed), 1, "km/h");
        let name = fill(PHRASES.runs.predicted_crush, &[("speed", speed)]);
        Row { name, cells: (0..runs.len()).map(cell).collect() }
    };
    speeds.into_iter().map(row).collect()
}

/// Places of a record where two runs are apart by more than what an engineer calls the same.
fn places_that_differ<T: Serialize>(topic: &str, a: &T, b: &T) -> BTreeSet<String> {
    let settings = CompareSettings {
        tolerances: Tolerances { base: Base::Engineering, ..Tolerances::default() },
        ..CompareSettings::default()
    };
    // Records of numbers, texts and maps become JSON, whatever is in them.
    let (Ok(a), Ok(b)) = (serde_json::to_value(a), serde_json::to_value(b)) else { return BTreeSet::new() };
    compare_json(topic, &a, &b, &settings).differences.into_iter().map(|difference| difference.place).collect()
}

/// Names of all lists, each once: those of the first, then what others add.
fn in_order<'a>(lists: impl Iterator<Item = Vec<&'a str>>) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for name in lists.flatten() {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

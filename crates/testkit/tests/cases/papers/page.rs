//! The page that shows every printed value beside the recomputed one.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde_json::Value;

use crate::papers::systems::evaluate;

/// Project-owned table: what the papers print, from which inputs, and why it differs.
pub const TABLE: &str = include_str!("values.json");

/// Widest line of the page, in characters.
const WIDTH: usize = 160;
/// Printed values of an item that all stand in its line; of more, how many agree and what differs.
const ALL_SHOWN: usize = 4;

/// The value at a path like `solutions.0.c1`.
fn at<'a>(value: &'a Value, path: &str) -> Option<&'a Value> {
    path.split('.').try_fold(value, |value, step| match step.parse::<usize>() {
        Ok(index) => value.get(index),
        Err(_) => value.get(step),
    })
}

/// Whether a recomputed value rounds to the printed one.
pub fn agrees(printed: &str, found: f64) -> bool {
    let Ok(value) = printed.parse::<f64>() else { return false };
    let decimals = printed.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    let unit = 10.0_f64.powi(-i32::try_from(decimals).unwrap_or(0));
    // A hair more than half a unit: halves may go either way.
    (found - value).abs() <= 0.5 * unit * (1.0 + 1e-9)
}

fn words(result: &str) -> &str {
    match result {
        "reproduces" => "reproduces",
        "reproduces-after-correction" => "corrected",
        "reproduces-approximately" => "about",
        _ => "differs",
    }
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

/// Printed values of an item and whether each is ticked, sorted.
pub type Ticks = Vec<(String, bool)>;

/// The ticks of an item, and the names of the values that a case file may compare though the paper prints none.
pub struct Shown {
    pub ticks: Ticks,
    pub not_printed: Vec<String>,
}

/// What is shown of every item.
pub fn shown() -> Result<BTreeMap<String, Shown>, String> {
    let table: Value = serde_json::from_str(TABLE).map_err(|e| e.to_string())?;
    let items = table["items"].as_array().cloned().unwrap_or_default();
    let text = |value: &Value, name: &str| value[name].as_str().unwrap_or_default().to_owned();
    let of = |item: &Value| {
        let id = text(item, "id");
        let found = evaluate(&text(item, "kind"), &item["inputs"]).map_err(|e| format!("{id}: {e}"))?;
        let mut ticks: Ticks = item["printed"]
            .as_array()
            .into_iter()
            .flatten()
            .map(|pair| {
                let print = text(pair, "printed");
                let value = at(&found, &text(pair, "of")).and_then(Value::as_f64);
                let same = value.is_some_and(|x| agrees(&print, x));
                (print, same)
            })
            .collect();
        ticks.sort();
        let names = item["not_printed"].as_array().into_iter().flatten();
        let not_printed = names.filter_map(|name| name.as_str().map(str::to_owned)).collect();
        Ok((id, Shown { ticks, not_printed }))
    };
    items.iter().map(of).collect()
}

/// What an item prints beside what is recomputed, as cells, each with whether both agree.
fn compared(item: &Value) -> Result<Vec<(bool, String)>, String> {
    let text = |value: &Value, name: &str| value[name].as_str().unwrap_or_default().to_owned();
    let found = evaluate(&text(item, "kind"), &item["inputs"]).map_err(|e| format!("{}: {e}", text(item, "id")))?;
    let cell_of = |pair: &Value| {
        let (name, print) = (text(pair, "name"), text(pair, "printed"));
        let value = at(&found, &text(pair, "of")).and_then(Value::as_f64);
        let decimals = print.split_once('.').map_or(0, |(_, fraction)| fraction.len()) + 1;
        match value {
            Some(x) if agrees(&print, x) => (true, format!("{name} {print} ✓")),
            Some(x) => (false, format!("{name} {print} → {x:.decimals$}")),
            None => (false, format!("{name} {print} → none")),
        }
    };
    Ok(item["printed"].as_array().into_iter().flatten().map(cell_of).collect())
}

/// The cells in one line: all of a few, else how many agree and one or two that differ.
fn shortened(cells: &[(bool, String)]) -> String {
    let differing: Vec<&str> = cells.iter().filter(|(same, _)| !same).map(|(_, cell)| cell.as_str()).collect();
    if cells.len() <= ALL_SHOWN {
        return cells.iter().map(|(_, cell)| cell.as_str()).collect::<Vec<_>>().join(", ");
    }
    let agree = format!("{} of {} ✓", cells.len() - differing.len(), cells.len());
    match differing.as_slice() {
        [] => agree,
        [_] | [_, _] => format!("{agree}: {}", differing.join(", ")),
        [first, ..] => format!("{agree}: {first}, ..."),
    }
}

/// The page.
pub fn page() -> Result<String, String> {
    let table: Value = serde_json::from_str(TABLE).map_err(|e| e.to_string())?;
    let list = |value: &Value, name: &str| value[name].as_array().cloned().unwrap_or_default();
    let text = |value: &Value, name: &str| value[name].as_str().unwrap_or_default().to_owned();
    let lines = |value: &Value, name: &str, start: &str| -> Vec<String> {
        list(value, name).iter().map(|line| format!("{start}{}", line.as_str().unwrap_or_default())).collect()
    };
    let (printed, others): (Vec<Value>, Vec<Value>) =
        list(&table, "items").into_iter().partition(|item| !list(item, "printed").is_empty());
    let mut body = String::new();
    let mut counts = BTreeMap::<String, usize>::new();
    let (mut numbers, mut agree) = (0, 0);
    for paper in list(&table, "papers") {
        let _ = writeln!(body, "## {}\n\n{}\n", text(&paper, "title"), text(&paper, "about"));
        let _ = writeln!(body, "| where | printed → recomputed | result |\n|---|---|---|");
        for item in printed.iter().filter(|item| item["paper"] == paper["id"]) {
            let cells = compared(item)?;
            numbers += cells.len();
            agree += cells.iter().filter(|(same, _)| *same).count();
            let (place, why) = (cell(&text(item, "place")), cell(&text(item, "why")));
            let result = words(&text(item, "verdict")).to_owned();
            let _ = writeln!(body, "| {place} | {} | {result}: {why} |", cell(&shortened(&cells)));
            *counts.entry(result).or_default() += 1;
        }
        let _ = writeln!(body, "\nFormulas and statements, with the reading that works:\n");
        let _ = writeln!(body, "{}\n", lines(&paper, "corrections", "- ").join("\n"));
    }
    let counts: Vec<String> = counts.iter().map(|(result, n)| format!("{n} {result}")).collect();
    let page = format!(
        "# The three papers, recomputed\n\n\
         <!-- Written by `just papers`; do not edit. -->\n\n\
         {}\n\n\
         {numbers} printed numbers at {} places: {agree} come out to the last digit (✓). Of the places, {}.\n\
         {} more quantities have no printed value; `just cases papers FILE` compares those with reference values.\n\
         Inputs of every line: `crates/testkit/tests/cases/papers/values.json`.\n\n{}\n",
        lines(&table, "about", "").join("\n"),
        printed.len(),
        counts.join(", "),
        others.len(),
        body.trim_end()
    );
    match page.lines().find(|line| line.chars().count() > WIDTH) {
        Some(line) => Err(format!("more than {WIDTH} characters: {line}")),
        None => Ok(page),
    }
}

//! The page that shows every printed value beside the recomputed one.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde_json::Value;

use crate::papers::systems::{complex_of, evaluate};

/// Project-owned table: what the papers print, from which inputs, and why it differs.
pub const TABLE: &str = include_str!("values.json");

/// Quantities shown where nothing is printed, by kind; empty: all single numbers.
fn headline(kind: &str) -> &'static [&'static str] {
    match kind {
        "charpoly_two_mass" => &["t", "u", "v", "w", "roots"],
        "crush" => &["t_m1", "C1", "t_m2", "C2"],
        "match" => {
            &["n_solutions_with_multiplicity", "n_real_with_multiplicity", "n_physical_with_multiplicity", "solutions"]
        }
        "transfer_function" => &["poles", "zeros"],
        "realization" => &["discrete_eigenvalues", "hankel_singular_values_first"],
        "roots_to_coefficients" => &["coefficients_descending_monic"],
        "eig" => &["modes_with_nonnegative_imaginary_part"],
        _ => &[],
    }
}

/// Ten significant digits, plain where that is short.
fn number(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let exponent = x.abs().log10().floor() as i32;
    if !(-5..12).contains(&exponent) {
        return if x.abs() < 1e-14 { "0".to_owned() } else { format!("{x:.9e}") };
    }
    let decimals = usize::try_from((9 - exponent).max(0)).unwrap_or(0);
    let text = format!("{x:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

fn show(value: &Value) -> String {
    if let Some(z) = complex_of(value) {
        return if z.im == 0.0 {
            number(z.re)
        } else {
            format!("{} {} {}i", number(z.re), if z.im < 0.0 { '-' } else { '+' }, number(z.im.abs()))
        };
    }
    match value {
        Value::Null => "none".to_owned(),
        Value::String(text) => text.clone(),
        Value::Bool(flag) => flag.to_string(),
        Value::Array(list) => list.iter().map(show).collect::<Vec<_>>().join(", "),
        Value::Object(map) => {
            // Of a solution the parameters, of a mode the pole.
            let keys: &[&str] =
                if map.contains_key("k1") { &["k1", "k2", "c1", "c2"] } else { &["lambda", "abs", "zeta"] };
            let parts: Vec<String> =
                keys.iter().filter_map(|k| map.get(*k).map(|v| format!("{k} {}", show(v)))).collect();
            format!("({})", parts.join(", "))
        }
        Value::Number(_) => String::new(),
    }
}

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
        "no-printed-value" => "nothing printed",
        "reproduces" => "reproduces",
        "reproduces-after-correction" => "reproduces after a correction",
        "reproduces-approximately" => "approximately",
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

/// The page, and how many printed quantities there are and agree.
pub fn page() -> Result<String, String> {
    let table: Value = serde_json::from_str(TABLE).map_err(|e| e.to_string())?;
    let list = |value: &Value, name: &str| value[name].as_array().cloned().unwrap_or_default();
    let items = list(&table, "items");
    let text = |value: &Value, name: &str| value[name].as_str().unwrap_or_default().to_owned();
    let mut body = String::new();
    let mut counts = BTreeMap::<String, usize>::new();
    let (mut printed_total, mut printed_agree) = (0, 0);
    for paper in list(&table, "papers") {
        let _ = writeln!(body, "## {}\n\n{}\n", text(&paper, "title"), text(&paper, "about"));
        let _ = writeln!(body, "| item | place | printed → recomputed | result | why |\n|---|---|---|---|---|");
        for item in items.iter().filter(|item| item["paper"] == paper["id"]) {
            let (id, kind) = (text(item, "id"), text(item, "kind"));
            let found = evaluate(&kind, &item["inputs"]).map_err(|e| format!("{id}: {e}"))?;
            let mut shown = Vec::new();
            for pair in list(item, "printed") {
                let (path, print) = (text(&pair, "of"), text(&pair, "printed"));
                let value = at(&found, &path).unwrap_or(&Value::Null);
                printed_total += 1;
                let same = value.as_f64().is_some_and(|x| agrees(&print, x));
                printed_agree += usize::from(same);
                let name = text(&pair, "name");
                shown.push(format!("{name}: {print} → {}{}", show(value), if same { " ✓" } else { "" }));
            }
            if shown.is_empty() {
                let keys = headline(&kind);
                let all = found.as_object().cloned().unwrap_or_default();
                if keys.is_empty() {
                    let single = |v: &Value| !v.is_array() && !v.is_object();
                    shown.extend(all.iter().filter(|(_, v)| single(v)).map(|(k, v)| format!("{k} = {}", show(v))));
                } else {
                    shown.extend(keys.iter().filter_map(|k| all.get(*k).map(|v| format!("{k} = {}", show(v)))));
                }
            }
            let result = words(&text(item, "verdict")).to_owned();
            let _ = writeln!(
                body,
                "| `{id}` | {} | {} | {result} | {} |",
                cell(&text(item, "place")),
                cell(&shown.join("; ")),
                cell(&text(item, "why"))
            );
            *counts.entry(result).or_default() += 1;
        }
        let corrections = list(&paper, "corrections");
        if !corrections.is_empty() {
            let _ = writeln!(body, "\nFormulas and statements, with the reading that works:\n");
            for line in corrections {
                let _ = writeln!(body, "- {}", line.as_str().unwrap_or_default());
            }
        }
        body.push('\n');
    }
    let counts: Vec<String> = counts.iter().map(|(result, n)| format!("{n} {result}")).collect();
    Ok(format!(
        "# The three papers, recomputed\n\n\
         <!-- Written by `just papers`; do not edit. -->\n\n\
         {}\n\n\
         {} items: {}. Of {printed_total} single printed numbers {printed_agree} come out to the last digit (✓).\n\n{}",
        text(&table, "about"),
        items.len(),
        counts.join(", "),
        body.trim_end().to_owned() + "\n"
    ))
}

//! The remarks of a run: each has a code that is explained, and each number of its sentence is one of its values.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use regex::Regex;
use serde_json::Value;

use crate::truth::run::Failure;

/// What is explained of every code: `crumple explain --markdown`, cut at its headings.
#[derive(Debug, Default)]
pub struct Explained(BTreeMap<String, String>);

impl Explained {
    /// By the program in a folder. Errors: it does not run.
    pub fn by(bin: &Path) -> Result<Self, Failure> {
        let output = Command::new(bin.join("crumple")).args(["explain", "--markdown"]).output()?;
        let text = String::from_utf8(output.stdout)?;
        let sections = text.split("## ").filter_map(|section| section.split_once('\n'));
        Ok(Self(sections.map(|(code, text)| (code.to_owned(), text.to_owned())).collect()))
    }

    /// The codes in their order.
    pub fn codes(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }
}

/// What units change a number by, between a value in SI units and a sentence.
const FACTORS: [f64; 12] = [
    1.0,
    1e3,
    1e-3,
    1e2,
    1e6,
    1e-6,
    3.6,
    3.6e3,
    1e9,
    1.0 / 9.80665,
    180.0 / std::f64::consts::PI,
    0.159_154_943_091_895,
];

/// Numbers of a sentence that are none of its values as shown, and stand neither in a name among the values nor in the
/// explanation of the code: thresholds and numbers of standards do.
pub fn unstated_numbers(remark: &Value, explained: &Explained) -> Vec<String> {
    let text = remark["text"].as_str().unwrap_or_default();
    let code = remark["code"].as_str().unwrap_or_default();
    let mut names = explained.0.get(code).cloned().unwrap_or_default();
    let mut numbers = Vec::new();
    for value in remark["values"].as_object().into_iter().flat_map(|values| values.values()) {
        match value {
            Value::String(name) => {
                let _infallible = write!(names, " {name}");
            }
            value => numbers.extend(value.as_f64()),
        }
    }
    // A number stands by itself, with a unit behind it at most: `k1` and `n4sid-4` are names.
    let number =
        Regex::new(r"(?:^|[\s(\[=<>±+])[-−]?(\d+(?:\.\d+)?(?:e-?\d+)?)").unwrap_or_else(|error| panic!("{error}"));
    let half_of = |digits: &str| {
        let places = digits.split_once('.').map_or(0, |(_, places)| places.len());
        0.5 * 10_f64.powi(-i32::try_from(places).unwrap_or(0))
    };
    let is_stated = |shown: &str| {
        let half = half_of(shown.split_once('e').map_or(shown, |(digits, _)| digits));
        let Ok(read) = shown.parse::<f64>() else { return false };
        let half = if shown.contains('e') { half * read.abs() } else { half };
        let is_shown =
            |value: f64| FACTORS.iter().any(|factor| ((value * factor).abs() - read).abs() <= half * 1.000_001);
        let stands_alone =
            || names.split(|c: char| !(c.is_ascii_digit() || c == '.')).any(|n| n.trim_matches('.') == shown);
        numbers.iter().any(|value| is_shown(*value)) || stands_alone()
    };
    let found = number.captures_iter(text).map(|found| found[1].to_owned());
    found.filter(|shown| !is_stated(shown)).collect()
}

/// Which codes which runs raised.
#[derive(Debug, Default)]
pub struct Raised(BTreeMap<String, (String, u64, BTreeSet<String>)>);

impl Raised {
    /// Notes the remarks of a run. Returns what is wrong with them: text and reason.
    pub fn add(&mut self, run: &str, remarks: &[Value], explained: &Explained) -> Vec<(String, String)> {
        let mut wrong = Vec::new();
        for remark in remarks {
            let text = |key: &str| remark[key].as_str().unwrap_or_default().to_owned();
            let code = text("code");
            let weight = remark["weight"].as_u64().unwrap_or_default();
            let (_, _, runs) = self.0.entry(code.clone()).or_insert_with(|| (text("stage"), weight, BTreeSet::new()));
            runs.insert(run.to_owned());
            if !explained.0.contains_key(&code) {
                wrong.push((text("text"), format!("nothing explains {code:?}")));
            }
            let unstated = unstated_numbers(remark, explained);
            if !unstated.is_empty() {
                wrong.push((text("text"), format!("{code}: no value is {}", unstated.join(", "))));
            }
        }
        wrong
    }

    /// As Markdown: code, stage, weight, how many runs raised it and one of them; then the codes that none raised.
    pub fn table(&self, explained: &Explained) -> String {
        let mut out = "\n| code | stage | weight | runs | one of them |\n|---|---|---|---|---|\n".to_owned();
        for (code, (stage, weight, runs)) in &self.0 {
            let first = runs.first().map_or("", String::as_str);
            let _infallible = writeln!(out, "| {code} | {stage} | {weight} | {} | {first} |", runs.len());
        }
        let none: Vec<&str> = explained.codes().filter(|code| !self.0.contains_key(*code)).collect();
        let _infallible = writeln!(out, "\n{} codes raised by no run: {}", none.len(), none.join(", "));
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_number_is_a_value_as_shown_or_stands_in_a_name_or_in_the_explanation() {
        let explained = Explained(BTreeMap::from([("CR999".to_owned(), "below 10 ms".to_owned())]));
        let unstated = |text: &str| {
            let values = json!({"time_s": 0.0123, "speed_m_per_s": 13.889, "id": "era-2/3", "share": 0.25});
            unstated_numbers(&json!({"code": "CR999", "values": values, "text": text}), &explained)
        };
        assert!(unstated("12.3 ms, 50.0 km/h, 25 %, era-2/3, less than 10 ms, k1 of n4sid-4").is_empty());
        assert_eq!(unstated("12.4 ms and 7 of them"), ["12.4", "7"]);
    }
}

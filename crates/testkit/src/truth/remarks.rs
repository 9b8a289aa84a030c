//! The remarks of a run: each has a code that is explained, each number of its sentence is one of its values, and its
//! values agree with the truth ([`codes`]).

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::numbers::{Shown, numbers};
use crate::truth::codes;
use crate::truth::found::Found;
use crate::truth::run::{Failure, Made};

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
const FACTORS: [f64; 12] = [1.0, 1e3, 1e-3, 1e2, 1e6, 1e-6, 3.6, 3.6e3, 1e9, 1.0 / 9.80665, 180.0 / PI, 0.5 / PI];

/// Numbers of a sentence that are none of its values as shown, and stand neither in a name among the values nor in the
/// explanation of the code: thresholds and numbers of standards do.
pub fn unstated_numbers(remark: &Value, explained: &Explained) -> Vec<String> {
    let mut names = explained.0.get(remark["code"].as_str().unwrap_or_default()).cloned().unwrap_or_default();
    let (mut values, mut counts) = (Vec::new(), Vec::new());
    for value in remark["values"].as_object().into_iter().flat_map(|values| values.values()) {
        // A list may be counted.
        counts.extend(value.as_str().map(|list| list.split(", ").count() as f64).filter(|count| *count > 1.0));
        names.extend(value.as_str().into_iter().flat_map(|name| [" ", name]));
        values.extend(value.as_f64());
    }
    let digits = names.split(|c: char| !(c.is_ascii_digit() || c == '.')).map(|number| number.trim_matches('.'));
    let mut named: Vec<f64> = digits.filter_map(|number| number.parse().ok()).collect();
    named.extend(counts);
    named.extend(numbers(&names).iter().map(|number| number.value.abs()));
    let is_value = |shown: &Shown| values.iter().any(|value| FACTORS.iter().any(|factor| shown.shows(value * factor)));
    let text = remark["text"].as_str().unwrap_or_default();
    let unstated = numbers(text).into_iter().filter(|shown| !is_value(shown) && !named.contains(&shown.value.abs()));
    unstated.map(|shown| shown.value.to_string()).collect()
}

/// Which codes which runs raised.
#[derive(Debug, Default)]
pub struct Raised(BTreeMap<String, (String, u64, BTreeSet<String>)>);

impl Raised {
    /// Notes the remarks of a run and checks each: code, what is found.
    pub fn check(&mut self, made: &Made, explained: &Explained) -> Vec<(String, Found)> {
        let one = |remark: &Value| {
            let text = |key: &str| remark[key].as_str().unwrap_or_default().to_owned();
            let (code, weight) = (text("code"), remark["weight"].as_u64().unwrap_or_default());
            let (_, _, runs) = self.0.entry(code.clone()).or_insert_with(|| (text("stage"), weight, BTreeSet::new()));
            runs.insert(made.name.clone());
            let mut found = Found::default();
            found.holds(explained.0.contains_key(&code), || "nothing explains this code".to_owned());
            let unstated = unstated_numbers(remark, explained);
            found.holds(unstated.is_empty(), || format!("no value is {}: {:?}", unstated.join(", "), text("text")));
            codes::check(made, remark, &mut found);
            (code, found)
        };
        made.list("/remarks").iter().map(one).collect()
    }

    /// As Markdown: code, stage, weight, how many runs raised it, one of them, what was compared; then the codes that
    /// none raised.
    pub fn table(&self, explained: &Explained) -> String {
        let mut out =
            "\n| code | stage | weight | runs | one of them | checked |\n|---|---|---|---|---|---|\n".to_owned();
        for (code, (stage, weight, runs)) in &self.0 {
            let first = runs.first().map_or("", String::as_str);
            let compared = codes::compared(code);
            let what = if compared.is_empty() { "numbers are values" } else { &compared };
            let _infallible = writeln!(out, "| {code} | {stage} | {weight} | {} | {first} | {what} |", runs.len());
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

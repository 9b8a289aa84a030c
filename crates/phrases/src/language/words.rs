//! The languages of a report, and numbers as each writes them.

use crumple_drawing::Words;
use crumple_drawing::numbers::{self, LONG_S, MILLI, NBSP, digits_of_interval};

use crate::names::definitions::DEFINITIONS;
use crate::names::metrics::{CHANNEL_STATES, ENGLISH_NAMES, METRICS, TRADE_NAMES};
use crate::phrases::{ENGLISH, GERMAN, Phrases};

/// A language that the report speaks.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Language {
    /// English.
    #[default]
    English,
    /// German.
    German,
}

impl Language {
    /// Codes of the languages there are, ISO 639-1.
    pub const CODES: [&str; 2] = ["en", "de"];

    /// The language of a code.
    pub fn of_code(code: &str) -> Option<Self> {
        match code {
            "en" => Some(Self::English),
            "de" => Some(Self::German),
            _ => None,
        }
    }

    /// Its code.
    pub const fn code(self) -> &'static str {
        match self {
            Self::English => "en",
            Self::German => "de",
        }
    }

    /// All that it says.
    pub const fn phrases(self) -> &'static Phrases {
        match self {
            Self::English => &ENGLISH,
            Self::German => &GERMAN,
        }
    }

    /// A number with its decimal mark.
    pub fn written(self, number: &str) -> String {
        match self {
            Self::English => number.to_owned(),
            Self::German => number.replace('.', ","),
        }
    }

    /// A number with so many decimals.
    pub fn decimals(self, value: f64, places: usize) -> String {
        self.written(&numbers::decimals(value, places))
    }

    /// A number with so many significant digits.
    pub fn significant(self, value: f64, digits: usize) -> String {
        self.written(&numbers::significant(value, digits))
    }

    /// A deviation with its sign.
    pub fn signed(self, value: f64, places: usize) -> String {
        self.written(&numbers::signed(value, places))
    }

    /// Up to so many decimals, without trailing zeros.
    pub fn at_most(self, value: f64, places: usize) -> String {
        self.written(&numbers::at_most(value, places))
    }

    /// A value in SI with four significant digits in the unit people use.
    pub fn value(self, value: f64, si: &str) -> String {
        let (factor, unit) = numbers::unit(si);
        with_unit(self.significant(factor * value, 4), unit)
    }

    /// A number with so many decimals and its unit: `749.9 mm`, in German `749,9 mm`.
    pub fn quantity(self, value: f64, places: usize, unit: &str) -> String {
        with_unit(self.decimals(value, places), unit)
    }

    /// A deviation with its sign and its unit.
    pub fn deviation(self, value: f64, places: usize, unit: &str) -> String {
        with_unit(self.signed(value, places), unit)
    }

    /// Two values in SI in the unit people use: `741.2 to 759.3 mm`.
    pub fn range(self, low: f64, high: f64, si: &str) -> String {
        let (factor, unit) = numbers::unit(si);
        let digits = digits_of_interval(low, high, 4);
        let [low, high] = [low, high].map(|end| self.significant(factor * end, digits));
        with_unit(self.between(&low, &high), unit)
    }

    /// `0.0 to 120.0 ms`, or in s where that is the fitting unit.
    pub fn times(self, from_s: f64, to_s: f64) -> String {
        let (factor, unit) = if to_s - from_s > LONG_S { (1.0, "s") } else { (MILLI, "ms") };
        let [from, to] = [from_s, to_s].map(|time| self.decimals(factor * time, 1));
        format!("{} {unit}", self.between(&from, &to))
    }

    /// `low to high`.
    pub fn between(self, low: &str, high: &str) -> String {
        format!("{low} {} {high}", self.phrases().page.to)
    }

    /// `90 %: ` before an interval; nothing where it has no level.
    pub fn level(self, percent: Option<u8>) -> String {
        percent.map_or_else(String::new, |percent| {
            fill(self.phrases().conclusion.level, &[("percent", percent.to_string())])
        })
    }

    /// Name of a metric or a measured quantity: `peak_acceleration` is "peak acceleration", `hic15` by its trade name
    /// "HIC15".
    pub fn metric(self, name: &str) -> String {
        let own = match self {
            Self::English => ENGLISH_NAMES.as_slice(),
            Self::German => METRICS.as_slice(),
        };
        let word = TRADE_NAMES.iter().chain(own).find(|(known, _)| *known == name);
        match word {
            Some((_, word)) => (*word).to_owned(),
            None => name.replace('_', " "),
        }
    }

    /// What is computed for a metric, by the key of its definition; `words`: what the record says. They stay as they
    /// are in English, without a key, where they bound the value in this record, and where they say why there is none.
    pub fn definition(self, key: Option<&str>, words: &str) -> String {
        let german = || DEFINITIONS.iter().find(|(known, _)| Some(*known) == key && self == Self::German);
        match german().filter(|_| !words.contains("bound") && !words.starts_with("absent")) {
            Some((_, german)) => (*german).to_owned(),
            None => words.to_owned(),
        }
    }

    /// Whether the data of a channel are there and right: `not installed`.
    pub fn channel_status(self, name: &str) -> &str {
        let german = CHANNEL_STATES.iter().find(|(known, _)| *known == name && self == Self::German);
        german.map_or(name, |(_, german)| german)
    }

    /// How an interval was found, as a record says it: `5-95 % of 400 replicates`.
    pub fn interval_by(self, words: &str) -> String {
        let replicates = words.strip_prefix("5-95 % of ").and_then(|rest| rest.strip_suffix(" replicates"));
        match (self, replicates) {
            (Self::German, Some(count)) => format!("5 bis 95 % von {count} Wiederholungen"),
            _ => words.to_owned(),
        }
    }

    /// What a drawing adds of its own.
    pub fn words_of_drawings(self) -> Words {
        let texts = &self.phrases().figures;
        Words {
            over: texts.over,
            lowest: texts.lowest,
            highest: texts.highest,
            at: texts.at,
            marked: texts.marked,
            panel: texts.panel,
            decimal_mark: if self == Self::German { ',' } else { '.' },
        }
    }
}

fn with_unit(number: String, unit: &str) -> String {
    if unit.is_empty() { number } else { format!("{number}{NBSP}{unit}") }
}

/// Puts texts in the place of `{name}`. A name without a text leaves nothing.
pub fn fill<T: AsRef<str>>(template: &str, texts: &[(&str, T)]) -> String {
    let mut out = String::with_capacity(2 * template.len());
    let mut rest = template;
    while let Some((before, behind)) = rest.split_once('{') {
        let (name, behind) = behind.split_once('}').unwrap_or((behind, ""));
        out.push_str(before);
        out.push_str(texts.iter().find(|(other, _)| *other == name).map_or("", |(_, text)| text.as_ref()));
        rest = behind;
    }
    out.push_str(rest);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn german_numbers_have_a_comma() {
        let (english, german) = (Language::English, Language::German);
        assert_eq!(english.quantity(749.93, 1, "mm"), "749.9\u{a0}mm");
        assert_eq!(german.quantity(-749.93, 1, "mm"), "−749,9\u{a0}mm");
        assert_eq!(
            (english.times(0.0, 0.0741).as_str(), german.times(0.0, 79.92).as_str()),
            ("0.0 to 74.1 ms", "0,0 bis 79,9 s")
        );
        assert_eq!(english.range(0.7412, 0.7593, "m"), "741.2 to 759.3\u{a0}mm");
        assert_eq!(german.range(0.5, 0.75, "1"), "0,5000 bis 0,7500");
        assert_eq!(english.range(0.75, 0.75, "1"), "0.7500 to 0.7500");
        for code in Language::CODES {
            assert_eq!(Language::of_code(code).map(Language::code), Some(code));
        }
    }

    #[test]
    fn a_metric_without_a_german_name_keeps_its_own() {
        let name = |language: Language, name| language.metric(name);
        assert_eq!(name(Language::English, "delta_v"), "delta v");
        assert_eq!(name(Language::German, "delta_v"), "Geschwindigkeitsänderung");
        assert_eq!(name(Language::English, "hic15"), "HIC15");
        assert_eq!(name(Language::German, "olc"), "OLC");
        let by = |language: Language| language.interval_by("5-95 % of 400 replicates");
        assert_eq!(by(Language::English), "5-95 % of 400 replicates");
        assert_eq!(by(Language::German), "5 bis 95 % von 400 Wiederholungen");
        assert_eq!(name(Language::German, "of_another_program"), "of another program");
    }

    #[test]
    fn names_are_replaced_and_texts_are_not_read_again() {
        assert_eq!(fill("a {x} b {y}{z}.", &[("x", "{y}"), ("y", "2")]), "a {y} b 2.");
    }
}

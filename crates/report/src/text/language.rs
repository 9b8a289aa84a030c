//! The languages of a report, and numbers as each writes them.

use crumple_drawing::numbers::{NBSP, decimals};

use super::phrases::{ENGLISH, GERMAN, Phrases};

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

    /// All that the verdict, its warnings and the console say.
    pub const fn phrases(self) -> &'static Phrases {
        match self {
            Self::English => &ENGLISH,
            Self::German => &GERMAN,
        }
    }

    /// A number with so many decimals and its unit: `749.9 mm`, in German `749,9 mm`.
    pub fn quantity(self, value: f64, places: usize, unit: &str) -> String {
        let number = decimals(value, places);
        let number = if self == Self::German { number.replace('.', ",") } else { number };
        if unit.is_empty() { number } else { format!("{number}{NBSP}{unit}") }
    }
}

/// Puts texts in the place of `{name}`. A name without a text leaves nothing.
pub fn fill(template: &str, texts: &[(&str, &str)]) -> String {
    let mut out = String::with_capacity(2 * template.len());
    let mut rest = template;
    while let Some((before, behind)) = rest.split_once('{') {
        let (name, behind) = behind.split_once('}').unwrap_or((behind, ""));
        out.push_str(before);
        out.push_str(texts.iter().find(|(other, _)| *other == name).map_or("", |(_, text)| text));
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
        assert_eq!(Language::English.quantity(749.93, 1, "mm"), "749.9\u{a0}mm");
        assert_eq!(Language::German.quantity(-749.93, 1, "mm"), "−749,9\u{a0}mm");
        for code in Language::CODES {
            assert_eq!(Language::of_code(code).map(Language::code), Some(code));
        }
    }

    #[test]
    fn names_are_replaced_and_texts_are_not_read_again() {
        assert_eq!(fill("a {x} b {y}{z}.", &[("x", "{y}"), ("y", "2")]), "a {y} b 2.");
    }
}

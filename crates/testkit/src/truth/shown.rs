//! Numbers as programs show them, and whether they are those of a record.

use serde_json::Value;

/// Factors from the SI unit of a record to the units that a text may show it in.
const UNITS: [(&str, f64); 18] = [
    ("mm", 1e3),
    ("ms", 1e3),
    ("km/h", 3.6),
    ("g", 1.0 / 9.806_65),
    ("kN·s/m", 1e-3),
    ("kN/m", 1e-3),
    ("kN", 1e-3),
    ("kJ", 1e-3),
    ("kg", 1.0),
    ("m/s²", 1.0),
    ("m/s^2", 1.0),
    ("m/s", 1.0),
    ("rad/s", 1.0),
    ("1/s", 1.0),
    ("%", 1.0),
    ("Hz", 1.0),
    ("m", 1.0),
    ("s", 1.0),
];

/// Half a unit of the last digit, and what binary fractions add.
const HALF: f64 = 0.500_000_1;

/// A number as a text shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Shown {
    /// As it is written, in its unit.
    pub value: f64,
    /// Digits after the point.
    pub decimals: usize,
    /// From SI to its unit; 1 of a number without one.
    pub factor: f64,
    /// Half of what its last digit counts, in its unit.
    half: f64,
}

impl Shown {
    /// Whether it is this number in SI, rounded as it is shown.
    pub fn is_of(&self, si: f64) -> bool {
        (si * self.factor - self.value).abs() <= self.half
    }

    /// Whether it is this number of a record, rounded as it is shown.
    pub fn is(&self, value: &Value) -> bool {
        value.as_f64().is_some_and(|value| self.is_of(value))
    }

    /// In SI.
    pub fn si(&self) -> f64 {
        self.value / self.factor
    }

    /// The number as it is written, in the unit of another.
    pub fn in_unit_of(&self, other: &Self) -> Self {
        Self { factor: other.factor, ..self.clone() }
    }

    /// The number as it is written, whatever its unit.
    pub fn without_unit(&self) -> Self {
        Self { factor: 1.0, ..self.clone() }
    }
}

/// A text with plain blanks and minus signs, one blank between words.
pub fn plain(text: &str) -> String {
    let text = text.replace(['\u{a0}', '\u{2009}', '\u{202f}'], " ").replace('−', "-").replace('\u{ad}', "");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The numbers of a text in their order. One without a unit, as before "to", has that of the next.
pub fn numbers(text: &str) -> Vec<Shown> {
    let text = plain(text);
    let mut shown: Vec<(Shown, Option<f64>)> = Vec::new();
    let mut rest = text.as_str();
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        let sign = if rest[..start].ends_with('-') { -1.0 } else { 1.0 };
        let is_name = rest[..start].ends_with(|c: char| c.is_alphabetic() || c == '_');
        let digits = &rest[start..];
        let end = digits.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(digits.len());
        let number = digits[..end].trim_end_matches('.');
        rest = &digits[number.len()..];
        let Some(value) = number.parse::<f64>().ok().filter(|_| !is_name) else { continue };
        let behind = rest.trim_start();
        let unit = UNITS.iter().find(|(unit, _)| {
            behind.strip_prefix(unit).is_some_and(|more| !more.starts_with(|c: char| c.is_alphanumeric() || c == '/'))
        });
        let decimals = number.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let half = HALF * last_digit(number, decimals);
        shown.push((Shown { value: sign * value, decimals, factor: 1.0, half }, unit.map(|(_, factor)| *factor)));
    }
    let mut factor = 1.0;
    for (number, own) in shown.iter_mut().rev() {
        factor = own.unwrap_or(factor);
        number.factor = factor;
    }
    shown.into_iter().map(|(number, _)| number).collect()
}

/// What the last digit of a number counts. Four significant digits are shown of a large one, so the zeros at the end of
/// one of five and more may be none of them.
fn last_digit(number: &str, decimals: usize) -> f64 {
    let zeros = number.len() - number.trim_end_matches('0').len();
    let not_shown = if decimals == 0 { zeros.min(number.len().saturating_sub(4)) } else { 0 };
    10f64.powf(not_shown as f64 - decimals as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_with_their_units() {
        let read = numbers("739.8 to 759.1\u{a0}mm, CFC60 at −0.5\u{a0}ms, 3 of 4");
        let expected = [(739.8, 1, 1e3), (759.1, 1, 1e3), (-0.5, 1, 1e3), (3.0, 0, 1.0), (4.0, 0, 1.0)];
        let read: Vec<(f64, usize, f64)> =
            read.iter().map(|shown| (shown.value, shown.decimals, shown.factor)).collect();
        assert_eq!(read, expected);
    }

    #[test]
    fn a_number_is_that_of_a_record_to_its_last_digit() {
        let one = |text: &str| numbers(text).remove(0);
        assert!(one("749.9 mm").is_of(0.749_93) && !one("749.9 mm").is_of(0.749_77));
        assert!(one("50 km/h").is_of(50.4 / 3.6) && !one("50 km/h").is_of(50.6 / 3.6));
        assert!(one("21610 kN/m").is_of(21_613e3) && !one("21610 kN/m").is_of(21_616e3));
    }
}

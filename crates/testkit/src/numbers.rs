//! Numbers of texts, with their units, and the numbers of `summary.json` that they have to be.

use std::f64::consts::TAU;

use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;
use serde_json::Value;

/// What is written, the end of names of such numbers in SI, the factor from them.
const UNITS: [(&str, &str, f64); 21] = [
    ("mm", "_m", 1e3),
    ("ms", "_s", 1e3),
    ("km/h", "_m_per_s", 3.6),
    ("g", "_m_per_s2", 1.0 / G),
    ("kN·s/m", "_n_s_per_m", 1e-3),
    ("kN/m", "_n_per_m", 1e-3),
    ("kN", "_n", 1e-3),
    ("kJ", "_j", 1e-3),
    ("kg", "_kg", 1.0),
    ("m/s²", "_m_per_s2", 1.0),
    ("m/s^2", "_m_per_s2", 1.0),
    ("m/s", "_m_per_s", 1.0),
    ("rad/s", "_rad_per_s", 1.0),
    ("Hz", "_rad_per_s", 1.0 / TAU),
    ("1/s", "_per_s", 1.0),
    ("s/m", "_s_per_m", 1.0),
    ("N/m", "_n_per_m", 1.0),
    ("%", "_percent", 1.0),
    ("J", "_j", 1.0),
    ("m", "_m", 1.0),
    ("s", "_s", 1.0),
];
/// Ends of names of numbers that are not in SI, and what they are in it; longer ends first.
const OTHER_ENDS: [(&str, &str, f64); 3] = [("_hz", "_rad_per_s", TAU), ("_ms", "_s", 1e-3), ("_g", "_m_per_s2", G)];

/// The unit that the name of a number states, as its end in SI, and the factor to it.
fn unit_of_name(name: &str) -> Option<(&'static str, f64)> {
    let si = UNITS.iter().map(|(_, end, _)| (*end, *end, 1.0));
    let all = si.chain(OTHER_ENDS).filter(|(end, ..)| name.ends_with(end));
    all.max_by_key(|(end, ..)| end.len()).map(|(_, si, factor)| (si, factor))
}

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
    /// Its own unit, as the end of names in SI.
    unit: Option<&'static str>,
    /// Half of what its last digit counts, in its unit.
    half: f64,
}

impl Shown {
    /// Whether it is this number in SI, rounded as it is shown.
    pub fn is_of(&self, si: f64) -> bool {
        (si * self.factor - self.value).abs() <= self.half
    }

    /// Whether it is this number in its own unit, whatever the sign.
    pub fn shows(&self, value: f64) -> bool {
        (value.abs() - self.value.abs()).abs() <= self.half
    }

    /// Whether it is this number of a record, rounded as it is shown.
    pub fn is(&self, value: &Value) -> bool {
        value.as_f64().is_some_and(|value| self.is_of(value))
    }
}

/// A text with plain blanks and minus signs, one blank between words.
pub fn plain(text: &str) -> String {
    let text = text.replace(['\u{a0}', '\u{2009}', '\u{202f}'], " ").replace('−', "-").replace('\u{ad}', "");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The unit that a text begins with, as the end of names in SI, and its factor.
fn unit_before(text: &str) -> Option<(&'static str, f64)> {
    let begins = |unit: &str| {
        let more = text.strip_prefix(unit)?;
        (!more.starts_with(|c: char| c.is_alphanumeric() || "/·²^".contains(c))).then_some(())
    };
    UNITS.into_iter().find_map(|(written, si, factor)| begins(written).map(|()| (si, factor)))
}

/// The numbers of a text in their order; those in names (`k1`, `era-4`, `1500kg`) are none. One without a unit, as
/// before "to", has the factor of the next.
pub fn numbers(text: &str) -> Vec<Shown> {
    let text = plain(text);
    let mut shown: Vec<Shown> = Vec::new();
    let mut rest = text.as_str();
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        let (before, digits) = rest.split_at(start);
        let end = digits.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(digits.len());
        let mantissa = digits[..end].trim_end_matches('.');
        let exponent = digits[mantissa.len()..].strip_prefix('e').map_or(0, |more| {
            let length = more.find(|c: char| !(c.is_ascii_digit() || c == '-')).unwrap_or(more.len());
            if more[..length].parse::<i32>().is_ok() { length + 1 } else { 0 }
        });
        let (number, behind) = digits.split_at(mantissa.len() + exponent);
        rest = behind;
        let in_name = |c: char| c.is_alphanumeric() || c == '_';
        let sign = before.ends_with('-');
        let is_name = before.strip_suffix(['-', '.', ':', '/']).unwrap_or(before).ends_with(in_name)
            || behind.starts_with(in_name)
            || behind.strip_prefix(['-', ':', '/', '·']).is_some_and(|more| more.starts_with(in_name));
        let Some(value) = number.parse::<f64>().ok().filter(|_| !is_name) else { continue };
        let unit = unit_before(behind.trim_start());
        let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let scale = if value == 0.0 { 1.0 } else { value / mantissa.parse::<f64>().unwrap_or(value) };
        let half = HALF * last_digit(mantissa, decimals, unit) * scale;
        let (unit, factor) = unit.map_or((None, f64::NAN), |(unit, factor)| (Some(unit), factor));
        shown.push(Shown { value: if sign { -value } else { value }, decimals, factor, unit, half });
    }
    let mut factor = 1.0;
    for number in shown.iter_mut().rev() {
        // A percentage is none of the unit of its neighbours.
        number.factor = if number.factor.is_nan() { factor } else { number.factor };
        factor = number.factor;
    }
    shown
}

/// Units of key numbers: below three digits they are shown to their decimals, whatever their interval; of three digits
/// the last may be none, where half of the interval is a hundred or more.
const TO_THEIR_DECIMALS: [&str; 4] = ["_m", "_s", "_m_per_s", "_m_per_s2"];

/// What the last digit of a number counts. What has an interval is shown with two significant digits of its half width,
/// so the zeros at the end of a whole number may be none of them.
fn last_digit(number: &str, decimals: usize, unit: Option<(&str, f64)>) -> f64 {
    let zeros = number.len() - number.trim_end_matches('0').len();
    let most = match unit {
        _ if decimals > 0 => 0,
        Some(("_percent" | "_kg", _)) => 0,
        Some((unit, _)) if TO_THEIR_DECIMALS.contains(&unit) && number.len() < 4 => usize::from(number.len() == 3),
        _ => number.len() - 1,
    };
    let not_shown = zeros.min(most);
    10f64.powf(not_shown as f64 - decimals as f64)
}

/// Fields whose texts are surfaces themselves; other texts are names, or were checked where they come from.
const SPOKEN: [&str; 6] =
    ["sentences", "status_sentence", "shown", "recommended_because", "simplest_because", "closest_because"];
/// Numbers that are in no summary, with their units, each with its reason.
const EXEMPT: [(f64, &str, &str); 11] = [
    (90.0, "_percent", "level of intervals"),
    (95.0, "_percent", "level of intervals of parameters"),
    (60.0, "", "class of the filter"),
    (180.0, "", "class of the filter"),
    (600.0, "", "class of the filter"),
    (1000.0, "", "class of the filter"),
    (3.0, "_s", "name of a criterion: 3 ms clip"),
    (563.0, "", "49 CFR 563"),
    (49.0, "", "49 CFR 563"),
    (18571.0, "", "ISO/TS 18571"),
    (60.0, "_rad_per_s", "edge of the filter, Hz"),
];
/// Units of the columns that a console prints predictions in.
const PREDICTED: [&str; 5] = ["km/h", "kg", "mm", "ms", "g"];

/// All numbers of a summary with their units, and all texts of it with a digit.
#[derive(Debug, Default)]
pub struct Pool {
    numbers: Vec<(&'static str, f64)>,
    texts: Vec<String>,
    most: f64,
}

impl Pool {
    /// Of a summary; a whole number up to the length of its longest list may be a count or a place.
    pub fn of(summary: &Value) -> Self {
        let mut pool = Self { most: 20.0, ..Self::default() };
        pool.add("", ("", 1.0), summary);
        pool.texts.sort_by_key(|text| std::cmp::Reverse(text.len()));
        pool
    }

    /// A number without a unit that the summary does not have.
    pub fn push(&mut self, value: f64) {
        self.numbers.push(("", value));
    }

    /// `unit` is what the object around it states.
    fn add(&mut self, name: &str, unit: (&'static str, f64), value: &Value) {
        let unit = unit_of_name(name).unwrap_or(unit);
        match value {
            Value::Number(number) => {
                let value = number.as_f64().unwrap_or(f64::NAN);
                self.numbers.push((unit.0, value * unit.1));
                // A count stands beside values whose unit the object states.
                self.numbers.extend((value.fract() == 0.0 && unit_of_name(name).is_none()).then_some(("", value)));
            }
            Value::String(text) if text.len() > 2 && text.contains(|c: char| c.is_ascii_digit()) => {
                self.texts.extend((!SPOKEN.contains(&name)).then(|| plain(text)));
            }
            Value::Array(values) => {
                self.most = self.most.max(values.len() as f64);
                values.iter().for_each(|value| self.add(name, unit, value));
            }
            Value::Object(fields) => {
                let text = |name: &str| fields.get(name).and_then(Value::as_str);
                let stated =
                    text("unit").map(|unit| unit_before(unit).map_or(("", 1.0), |(si, factor)| (si, 1.0 / factor)));
                let of_quantity = || match text("quantity")? {
                    "displacement" => Some(("_m", 1.0)),
                    "velocity" => Some(("_m_per_s", 1.0)),
                    _ => None,
                };
                let unit = stated.or(text("name").and_then(unit_of_name)).or_else(of_quantity).unwrap_or(unit);
                let shown = fields.iter().filter(|(name, _)| !["correlation", "numbers"].contains(&name.as_str()));
                shown.for_each(|(name, value)| self.add(name, unit, value));
            }
            _ => {}
        }
    }

    /// Numbers of a text that are none of these: each line for itself. A number without a unit has one of its line, or
    /// one of the heads of its table.
    pub fn unstated(&self, text: &str) -> Vec<String> {
        let mut wrong = Vec::new();
        let mut heads: Vec<String> = Vec::new();
        for line in text.lines().map(plain).filter(|line| !line.is_empty()) {
            let is_of_predictions = line.starts_with("predict ");
            let line = if is_of_predictions { line.replace("..", " to ") } else { line };
            let line = self.texts.iter().fold(line, |line, known| without(line, known));
            let cells: Vec<&str> = line.split('|').collect();
            if cells.len() == 1 {
                heads.clear();
            } else if heads.is_empty() {
                heads = cells.iter().map(|cell| (*cell).to_owned()).collect();
            }
            let columns = PREDICTED.iter().filter(|_| is_of_predictions).copied();
            let of_heads = heads.iter().filter_map(|head| head.trim().rsplit([' ', ',']).next()).chain(columns);
            let of_heads: Vec<_> = of_heads.filter_map(unit_before).chain([("", 1.0)]).collect();
            for cell in cells {
                let shown = numbers(cell);
                let units = shown.iter().filter_map(|shown| shown.unit.map(|unit| (unit, shown.factor)));
                let around: Vec<_> = units.chain(of_heads.iter().copied()).collect();
                let unstated = shown.iter().filter(|shown| !self.has(shown, &around));
                wrong.extend(unstated.map(|shown| format!("{} in {:?}", shown.value, cell.trim())));
            }
        }
        wrong
    }

    fn has(&self, shown: &Shown, around: &[(&str, f64)]) -> bool {
        let is_in = |(unit, factor): (&str, f64)| {
            let is_share = |own: &str| own.is_empty() && unit == "_percent";
            self.numbers.iter().any(|(own, value)| {
                *own == unit && shown.shows(value * factor) || is_share(own) && shown.shows(100.0 * value)
            })
        };
        let unit = shown.unit.unwrap_or_default();
        let is_exempt = EXEMPT.iter().any(|(value, of, _)| *value == shown.value && *of == unit);
        let is_count = unit.is_empty() && shown.decimals == 0 && (0.0..=self.most).contains(&shown.value);
        let own = [(unit, shown.factor)];
        is_exempt || is_count || if unit.is_empty() { around } else { &own }.iter().any(|unit| is_in(*unit))
    }
}

/// A line without a text that was checked elsewhere, whole or as a console cuts it, with three dots.
fn without(line: String, known: &str) -> String {
    let line = line.replace(known, " ");
    let begins = |length: usize| known.char_indices().nth(length).map(|(end, _)| &known[..end]);
    let cut = begins(30).and_then(|start| {
        let at = line.find(start)?;
        let end = at + line[at..].find(" ...")?;
        known.starts_with(&line[at..end]).then(|| format!("{}{}", &line[..at], &line[end..]))
    });
    cut.unwrap_or(line)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn numbers_are_read_with_their_units() {
        let read = numbers("739.8 to 759.1\u{a0}mm, CFC60 at −0.5\u{a0}ms, 3 of 4, k1, era-4, 1500kg and 1.19e-5 m");
        let expected =
            [(739.8, 1, 1e3), (759.1, 1, 1e3), (-0.5, 1, 1e3), (3.0, 0, 1.0), (4.0, 0, 1.0), (1.19e-5, 2, 1.0)];
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

    #[test]
    fn a_number_of_a_surface_is_one_of_the_summary_in_its_unit() {
        let summary = json!({"events": {"dynamic_crush_m": 0.6956, "speed_m_per_s": 15.5556}, "fit_percent": 99.96,
            "key_numbers": [{"value": 314.49, "unit": "m/s^2", "low": 311.2, "high": 317.9}],
            "place": "Hybrid III 51 %"});
        let unstated = |text: &str| Pool::of(&summary).unstated(text);
        let right = "crush 696 mm at 56 km/h\nOLC 32.1 g (90 %: 31.7 to 32.4)\nfit 100.0 %, Hybrid III 51 %\n\
                     | km/h | crush, mm |\n|---|---|\n| 56 | 696 |";
        assert_eq!(unstated(right), Vec::<String>::new());
        // A wrong digit, a wrong unit, a wrong cell.
        assert_eq!(unstated("crush 697 mm"), ["697 in \"crush 697 mm\""]);
        assert_eq!(unstated("crush 696 ms"), ["696 in \"crush 696 ms\""]);
        assert_eq!(unstated("| km/h |\n| 57 |"), ["57 in \"57\""]);
    }
}

//! The units in which people read: metric ones, or those of the United States. What is computed and what is stored is
//! SI; a number, the head of a column, an axis and a sentence of a file are shown through the one table here.

use std::borrow::Cow;
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, Ordering};

use super::unit::{FOOT_M, INCH_M, MILE_M, POUND_KG};
use crate::STANDARD_GRAVITY_M_PER_S2;

/// Which units people read.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Display {
    /// km/h, mm, kg, kN, g.
    #[default]
    Si,
    /// mph, in, lb, kip (1000 lbf), g.
    Us,
}

/// What stands in a pipeline and behind `--display`.
pub const DISPLAYS: [(&str, Display); 2] = [("si", Display::Si), ("us", Display::Us)];

/// Text that names no units to show.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} names no units to show: write si or us")]
pub struct UnknownDisplay(String);

impl FromStr for Display {
    type Err = UnknownDisplay;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let named = DISPLAYS.iter().find(|(name, _)| *name == text);
        named.map(|(_, display)| *display).ok_or_else(|| UnknownDisplay(text.to_owned()))
    }
}

/// Whether this process shows units of the United States now.
static IS_US: AtomicBool = AtomicBool::new(false);

/// Puts back what was shown before.
struct Before(bool);

impl Drop for Before {
    fn drop(&mut self) {
        IS_US.store(self.0, Ordering::Relaxed);
    }
}

impl Display {
    /// What this process shows now, in all its threads.
    pub fn now() -> Self {
        if IS_US.load(Ordering::Relaxed) { Self::Us } else { Self::Si }
    }

    /// Shows these units while a page or a table is laid out. What goes into an artifact or a summary is made outside.
    pub fn during<T>(self, lay_out: impl FnOnce() -> T) -> T {
        let _before = Before(IS_US.swap(self == Self::Us, Ordering::Relaxed));
        lay_out()
    }
}

/// A unit of metric pages in the United States.
struct Row {
    metric: &'static str,
    us: &'static str,
    /// US units in one metric unit.
    factor: f64,
    /// Decimals more or fewer for the same resolution, by whole digits.
    decimals: i32,
}

const fn row(metric: &'static str, us: &'static str, factor: f64, decimals: i32) -> Row {
    Row { metric, us, factor, decimals }
}

/// lbf in a newton.
const LBF: f64 = 1.0 / (POUND_KG * STANDARD_GRAVITY_M_PER_S2);
/// lbf/in in N/m.
const LBF_PER_IN: f64 = LBF * INCH_M;
/// ft·lbf in a joule.
const FT_LBF: f64 = LBF / FOOT_M;

/// Longer names first, so that none is taken for the start of another.
const UNITS: [Row; 31] = [
    row("kN·s/m", "lb·s/in", 1e3 * LBF_PER_IN, 0),
    row("kN s/m", "lb s/in", 1e3 * LBF_PER_IN, 0),
    row("N·s/m", "lb·s/in", LBF_PER_IN, 2),
    row("N s/m", "lb s/in", LBF_PER_IN, 2),
    row("m²/s²", "ft²/s²", 1.0 / (FOOT_M * FOOT_M), 0),
    row("m^2/s^2", "ft^2/s^2", 1.0 / (FOOT_M * FOOT_M), 0),
    row("kN/m²", "lb/in²", 1e3 * LBF * INCH_M * INCH_M, 1),
    row("kN/m^2", "lb/in^2", 1e3 * LBF * INCH_M * INCH_M, 1),
    row("N/m²", "lb/in²", LBF * INCH_M * INCH_M, 4),
    row("N/m^2", "lb/in^2", LBF * INCH_M * INCH_M, 4),
    row("kN/mm", "kip/in", LBF_PER_IN * 1e3, 0),
    row("kN/m", "lb/in", 1e3 * LBF_PER_IN, 0),
    row("N/mm", "lb/in", 1e3 * LBF_PER_IN, 0),
    row("N/m", "lb/in", LBF_PER_IN, 2),
    row("N·m", "ft·lb", FT_LBF, 0),
    row("J/kg", "ft·lb/lb", FT_LBF * POUND_KG, 0),
    row("km/h", "mph", 1e3 / MILE_M, 0),
    row("mm/s", "in/s", 1e-3 / INCH_M, 1),
    row("m/s²", "ft/s²", 1.0 / FOOT_M, 0),
    row("m/s^2", "ft/s^2", 1.0 / FOOT_M, 0),
    row("m/s", "ft/s", 1.0 / FOOT_M, 0),
    row("s/m", "s/ft", FOOT_M, 0),
    row("kPa", "psi", 1e3 * LBF * INCH_M * INCH_M, 1),
    row("kN", "kip", LBF, 1),
    row("kJ", "kip·ft", FT_LBF, 0),
    row("kg", "lb", 1.0 / POUND_KG, 0),
    row("mm", "in", 1e-3 / INCH_M, 1),
    row("cm", "in", 1e-2 / INCH_M, 0),
    row("m", "in", 1.0 / INCH_M, -2),
    row("N", "lbf", LBF, 0),
    row("J", "ft·lb", FT_LBF, 0),
];

fn row_of(unit: &str) -> Option<&'static Row> {
    let is_us = Display::now() == Display::Us;
    is_us.then(|| UNITS.iter().find(|row| row.metric == unit)).flatten()
}

/// How a quantity is shown, where metric pages show it with this factor from SI, these decimals and this unit.
pub fn shown((factor, decimals, unit): (f64, usize, &'static str)) -> (f64, usize, &'static str) {
    row_of(unit).map_or((factor, decimals, unit), |row| (factor * row.factor, row.decimals_of(decimals), row.us))
}

/// The name of a unit of metric pages.
pub fn unit_shown(unit: &str) -> &str {
    row_of(unit).map_or(unit, |row| row.us)
}

/// What a number in a unit of metric pages is multiplied by.
pub fn factor_shown(unit: &str) -> f64 {
    row_of(unit).map_or(1.0, |row| row.factor)
}

/// Decimals of a number that has so many in a unit of metric pages.
pub fn decimals_shown(decimals: usize, unit: &str) -> usize {
    row_of(unit).map_or(decimals, |row| row.decimals_of(decimals))
}

impl Row {
    fn decimals_of(&self, decimals: usize) -> usize {
        decimals.saturating_add_signed(self.decimals as isize)
    }
}

// Sentences of files: remarks, definitions and notes that a stage has written, of this project or of another program.

/// Between two numbers of which the second has the unit of both.
const BETWEEN: [&str; 6] = [" to ", " and ", " or ", " ± ", "..", " +/- "];

/// A number in a sentence: its place, its digits behind the point, and where its unit stands.
struct Stated {
    from: usize,
    to: usize,
    value: f64,
    decimals: usize,
}

/// A sentence of a file as people read it: each number with a unit of the table, and each range, in the unit shown.
/// Numbers without a unit stay, and so does what stands between words: identifiers, names of channels, `CFC 60`.
pub fn sentence(text: &str) -> Cow<'_, str> {
    if Display::now() == Display::Si {
        return Cow::Borrowed(text);
    }
    let numbers = numbers(text);
    let mut rows: Vec<Option<(&Row, usize)>> = numbers.iter().map(|number| unit_behind(text, number)).collect();
    for k in (1..numbers.len()).rev() {
        let joined = BETWEEN.contains(&&text[numbers[k - 1].to..numbers[k].from]);
        if let (Some((row, _)), None, true) = (rows[k], rows[k - 1], joined) {
            rows[k - 1] = Some((row, numbers[k - 1].to));
        }
    }
    let (mut out, mut at) = (String::with_capacity(text.len()), 0);
    for (number, row) in numbers.iter().zip(&rows) {
        let Some((row, end)) = row else { continue };
        out.push_str(&text[at..number.from]);
        let value = row.factor * number.value;
        out.push_str(&format!("{value:.*}", row.decimals_of(number.decimals)));
        // A number of a range has its unit behind the last one.
        if *end > number.to {
            out.push_str(&text[number.to..*end - row.metric.len()]);
            out.push_str(row.us);
        }
        at = *end;
    }
    out.push_str(&text[at..]);
    Cow::Owned(out)
}

/// The unit right behind a number, or behind one blank, and the place where it ends.
fn unit_behind(text: &str, number: &Stated) -> Option<(&'static Row, usize)> {
    let behind = &text[number.to..];
    let blank = behind.chars().next().filter(|c| [' ', '\u{a0}'].contains(c)).map_or(0, char::len_utf8);
    let rest = &behind[blank..];
    let row = UNITS.iter().find(|row| rest.starts_with(row.metric))?;
    let after = rest[row.metric.len()..].chars().next();
    let is_whole = after.is_none_or(|c| !(c.is_alphanumeric() || ['/', '^', '·', '*', '²', '_'].contains(&c)));
    is_whole.then_some((row, number.to + blank + row.metric.len()))
}

/// The numbers of a text that are not part of a word.
fn numbers(text: &str) -> Vec<Stated> {
    let bytes = text.as_bytes();
    let (mut found, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        if !bytes[at].is_ascii_digit() {
            at += 1;
            continue;
        }
        let from = at;
        while at < bytes.len()
            && (bytes[at].is_ascii_digit() || (bytes[at] == b'.' && bytes.get(at + 1).is_some_and(u8::is_ascii_digit)))
        {
            at += 1;
        }
        let before = text[..from].chars().next_back();
        let is_in_a_word = before.is_some_and(|c| c.is_alphanumeric() || ['_', '-', '#'].contains(&c));
        let is_negative = before == Some('-') && !text[..from - 1].ends_with(char::is_alphanumeric);
        let digits = &text[from..at];
        if let (Ok(value), true) = (digits.parse::<f64>(), !is_in_a_word || is_negative) {
            let decimals = digits.split_once('.').map_or(0, |(_, behind)| behind.len());
            found.push(Stated { from, to: at, value, decimals });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::QuantityKind;
    use crate::key_quantities::{CRUSH, SPEED};

    fn us<T>(show: impl FnOnce() -> T) -> T {
        Display::Us.during(show)
    }

    #[test]
    fn units_are_those_of_the_reader_while_a_page_is_laid_out() {
        let crush = us(|| CRUSH.shown());
        assert!((crush.0 * 0.0254 - 1.0).abs() < 1e-12 && (crush.1, crush.2) == (1, "in"));
        let speed = us(|| SPEED.shown());
        assert!((speed.0 * 0.44704 - 1.0).abs() < 1e-12 && speed.2 == "mph");
        assert_eq!(Display::now(), Display::Si);
        assert_eq!((SPEED.shown().2, CRUSH.head().as_str()), ("km/h", "C, mm"));
    }

    #[test]
    fn a_sentence_of_a_file_has_its_numbers_in_the_unit_of_the_reader() {
        for (metric, expected) in [
            ("the mass of 1500 kg is assumed", "the mass of 3307 lb is assumed"),
            ("690 to 810 mm, at 56.3 km/h", "27.2 to 31.9 in, at 35.0 mph"),
            ("state it: --impact-speed 35km/h at ingest", "state it: --impact-speed 22mph at ingest"),
            ("drift of -0.30 m/s^2 at 80 ms", "drift of -0.98 ft/s^2 at 80 ms"),
            ("channel 93 of kelvin/direct-fit/1, CFC 60, 5 m2", "channel 93 of kelvin/direct-fit/1, CFC 60, 5 m2"),
            ("below 0.8\u{a0}km/h", "below 0.5\u{a0}mph"),
        ] {
            assert_eq!(us(|| sentence(metric).into_owned()), expected);
            assert_eq!(sentence(metric), metric);
        }
    }

    #[test]
    fn every_unit_of_the_table_is_one_that_values_can_be_typed_in() {
        use crate::unit::{Dimension, factor};
        use QuantityKind::{Acceleration, Displacement, Force, Pressure, Velocity};
        let signals = [Acceleration, Velocity, Displacement, Force, Pressure].map(Dimension::Signal);
        let dimensions = signals.into_iter().chain([Dimension::Mass, Dimension::Stiffness, Dimension::Damping]);
        let mut compared = 0;
        for (row, dimension) in UNITS.iter().flat_map(|row| dimensions.clone().map(move |of| (row, of))) {
            let Some((metric, us)) = factor(row.metric, dimension).zip(factor(row.us, dimension)) else { continue };
            // Constants of seven digits and more on either side, so rounding alone is left.
            assert!((row.factor * us / metric - 1.0).abs() < 1e-12, "{}", row.metric);
            compared += 1;
        }
        assert!(compared > 15, "{compared}");
    }
}

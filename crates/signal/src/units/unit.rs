//! Units people write, and their factors to SI.
//!
//! Used where values come in (files, flags, pipeline tables) and go out to people (summaries, the report).

use std::sync::LazyLock;

use crate::{QuantityKind, STANDARD_GRAVITY_M_PER_S2};

/// What a unit measures, beyond the quantities of signals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Dimension {
    /// A quantity that signals have.
    Signal(QuantityKind),
    /// Mass; SI unit kg.
    Mass,
    /// Time; SI unit s.
    Time,
    /// Frequency; unit Hz.
    Frequency,
    /// Share of a whole; unit 1.
    Share,
    /// Force over displacement; SI unit N/m.
    Stiffness,
    /// Force over speed; SI unit N·s/m.
    Damping,
    /// Area; SI unit m².
    Area,
}

impl Dimension {
    /// Symbol of the SI unit, for messages; a share is asked for in percent.
    pub fn si_unit(self) -> &'static str {
        match self {
            Self::Signal(kind) => kind.si_unit(),
            Self::Mass => "kg",
            Self::Time => "s",
            Self::Frequency => "Hz",
            Self::Share => "%",
            Self::Stiffness => "N/m",
            Self::Damping => "N*s/m",
            Self::Area => "m2",
        }
    }

    /// Symbol of the unit that people type most, for messages.
    pub fn usual_unit(self) -> &'static str {
        match self {
            Self::Signal(QuantityKind::Velocity) => "km/h",
            _ => self.si_unit(),
        }
    }

    /// What it is called in a message.
    pub fn name(self) -> &'static str {
        match self {
            Self::Signal(QuantityKind::Velocity) => "speed",
            Self::Signal(QuantityKind::Displacement) => "length",
            Self::Signal(kind) => kind.name(),
            Self::Mass => "mass",
            Self::Time => "time",
            Self::Frequency => "frequency",
            Self::Share => "share",
            Self::Stiffness => "stiffness",
            Self::Damping => "damping",
            Self::Area => "area",
        }
    }
}

pub(super) const MILE_M: f64 = 1609.344;
pub(super) const INCH_M: f64 = 0.0254;
pub(super) const FOOT_M: f64 = 0.3048;
pub(super) const POUND_KG: f64 = 0.453_592_37;
const DEGREE_RAD: f64 = std::f64::consts::PI / 180.0;

use Dimension::{Area, Damping, Frequency, Mass, Share, Signal, Stiffness, Time};
use QuantityKind as Q;

/// `(spellings, dimension, factor to SI)`. The first spelling is the usual one.
/// Spellings are compared as [`squeeze`] writes them; letters keep their case where two units differ by it.
const UNITS: &[(&[&str], Dimension, f64)] = &[
    (&["m/s^2", "meters/s^2", "metres/s^2", "meter/s^2", "metre/s^2", "m s-2", "mps2"], Signal(Q::Acceleration), 1.0),
    (
        &[
            "g", "G", "g's", "G'S", "G's", "gs", "Gs", "g0", "gn", "g_n", "G_n", "grav", "gee", "gees", "g-force",
            "G-force", "G-Force", "G-FORCE", "gforce", "GForce", "Gforce",
        ],
        Signal(Q::Acceleration),
        STANDARD_GRAVITY_M_PER_S2,
    ),
    (
        &["mg", "milli-g", "milli-G", "millig", "milliG", "mgn", "mg_n"],
        Signal(Q::Acceleration),
        1e-3 * STANDARD_GRAVITY_M_PER_S2,
    ),
    (&["ug", "µg", "μg", "micro-g", "microg"], Signal(Q::Acceleration), 1e-6 * STANDARD_GRAVITY_M_PER_S2),
    (
        &["kilo-g", "kilo-G", "kG", "kilog", "kiloG", "kgn", "kg_n"],
        Signal(Q::Acceleration),
        1e3 * STANDARD_GRAVITY_M_PER_S2,
    ),
    (&["mm/s^2"], Signal(Q::Acceleration), 1e-3),
    (&["cm/s^2", "Gal", "gal"], Signal(Q::Acceleration), 1e-2),
    (&["mGal", "mgal", "milligal"], Signal(Q::Acceleration), 1e-5),
    (&["ft/s^2", "feet/s^2", "foot/s^2", "fps2", "ft s-2"], Signal(Q::Acceleration), FOOT_M),
    (&["in/s^2", "inch/s^2", "inches/s^2", "ips2", "in s-2"], Signal(Q::Acceleration), INCH_M),
    // Sets of units of simulations: ms, mm, kg; and ms, m, kg.
    (&["mm/ms^2"], Signal(Q::Acceleration), 1e3),
    (&["m/ms^2"], Signal(Q::Acceleration), 1e6),
    (&["m/s", "m\\s", "mps", "mm/ms", "m s-1", "meters/s", "metres/s"], Signal(Q::Velocity), 1.0),
    (&["km/h", "km\\h", "kph", "kmh", "kmph", "KMH", "km/hr"], Signal(Q::Velocity), 1.0 / 3.6),
    (&["mph", "MPH", "mi/h"], Signal(Q::Velocity), MILE_M / 3600.0),
    (&["mm/s"], Signal(Q::Velocity), 1e-3),
    (&["ft/s", "feet/s"], Signal(Q::Velocity), FOOT_M),
    (&["m", "metre", "meter", "metres", "meters"], Signal(Q::Displacement), 1.0),
    (&["cm"], Signal(Q::Displacement), 1e-2),
    (&["mm", "MM"], Signal(Q::Displacement), 1e-3),
    (&["um", "µm", "μm"], Signal(Q::Displacement), 1e-6),
    (&["in", "inch", "\""], Signal(Q::Displacement), INCH_M),
    (&["ft"], Signal(Q::Displacement), FOOT_M),
    (&["N", "NWT"], Signal(Q::Force), 1.0),
    (&["kN", "KN"], Signal(Q::Force), 1e3),
    (&["lbf"], Signal(Q::Force), POUND_KG * STANDARD_GRAVITY_M_PER_S2),
    (&["kip", "kips"], Signal(Q::Force), 1e3 * POUND_KG * STANDARD_GRAVITY_M_PER_S2),
    (&["N*m", "Nm", "N.m", "N·m", "NWM"], Signal(Q::Moment), 1.0),
    (&["kN*m", "kNm"], Signal(Q::Moment), 1e3),
    (&["rad"], Signal(Q::Angle), 1.0),
    (&["deg", "DEG", "°", "degree", "degrees"], Signal(Q::Angle), DEGREE_RAD),
    (&["rad/s"], Signal(Q::AngularVelocity), 1.0),
    (&["deg/s", "DPS", "dps", "°/s"], Signal(Q::AngularVelocity), DEGREE_RAD),
    (&["rad/s^2", "RP2"], Signal(Q::AngularAcceleration), 1.0),
    (&["deg/s^2", "DP2"], Signal(Q::AngularAcceleration), DEGREE_RAD),
    (&["Pa", "PAS", "N/m^2"], Signal(Q::Pressure), 1.0),
    (&["kPa", "KPA", "kN/m^2"], Signal(Q::Pressure), 1e3),
    (&["bar"], Signal(Q::Pressure), 1e5),
    (&["MPa", "N/mm^2"], Signal(Q::Pressure), 1e6),
    (&["psi", "lbf/in^2", "lb/in^2"], Signal(Q::Pressure), POUND_KG * STANDARD_GRAVITY_M_PER_S2 / (INCH_M * INCH_M)),
    (&["V", "VOL", "volt", "volts"], Signal(Q::Voltage), 1.0),
    (&["mV"], Signal(Q::Voltage), 1e-3),
    (&["kg"], Mass, 1.0),
    (&["t", "tonne", "tonnes"], Mass, 1e3),
    (&["lb", "lbs", "lbm"], Mass, POUND_KG),
    (&["s", "sec", "SEC", "seconds", "second"], Time, 1.0),
    (&["ms", "MS", "msec", "milliseconds"], Time, 1e-3),
    (&["us", "µs", "μs", "usec", "microseconds", "microsecond"], Time, 1e-6),
    (&["ns", "nsec", "nanoseconds", "nanosecond"], Time, 1e-9),
    (&["min", "minutes", "minute"], Time, 60.0),
    (&["h", "hours", "hour"], Time, 3600.0),
    (&["d", "days", "day"], Time, 86_400.0),
    (&["Hz", "hz", "1/s", "/s"], Frequency, 1.0),
    (&["kHz"], Frequency, 1e3),
    (&["%", "percent"], Share, 1e-2),
    (&["share"], Share, 1.0),
    (&["kN/m"], Stiffness, 1e3),
    (&["N/m"], Stiffness, 1.0),
    (&["N/mm"], Stiffness, 1e3),
    (&["kN/mm", "MN/m"], Stiffness, 1e6),
    (&["lbf/in", "lb/in"], Stiffness, POUND_KG * STANDARD_GRAVITY_M_PER_S2 / INCH_M),
    (&["kN*s/m", "kN·s/m", "kNs/m", "kN.s/m", "kN/(m/s)"], Damping, 1e3),
    (&["N*s/m", "N·s/m", "Ns/m", "N.s/m", "N/(m/s)"], Damping, 1.0),
    (&["N*s/mm", "N·s/mm", "Ns/mm", "N.s/mm"], Damping, 1e3),
    (&["lbf*s/in"], Damping, POUND_KG * STANDARD_GRAVITY_M_PER_S2 / INCH_M),
    (&["m2"], Area, 1.0),
    (&["cm2"], Area, 1e-4),
    (&["mm2"], Area, 1e-6),
];

/// Without blanks, powers and quotients of seconds in one spelling: `m/s²`, `m/s^2`, `m/s**2`, `m/sec/sec` and
/// `m/(s*s)` are `m/s2`, `m·s⁻²` is `ms-2`, `g’s` is `g's`.
fn squeeze(text: &str) -> String {
    let plain = text.replace("**", "");
    let plain = plain.chars().filter(|c| !c.is_whitespace() && *c != '^').map(|c| match c {
        '⁻' | '−' => '-',
        '¹' => '1',
        '²' => '2',
        '’' | '`' | '´' => '\'',
        c => c,
    });
    let mut plain: String = plain.collect();
    for (spelling, usual) in [
        ("/seconds", "/s"),
        ("/second", "/s"),
        ("/sec", "/s"),
        ("/msec", "/ms"),
        ("/s/s", "/s2"),
        ("/(s*s)", "/s2"),
        ("/(s2)", "/s2"),
        ("/ms/ms", "/ms2"),
        ("/(ms*ms)", "/ms2"),
        ("*s-", "s-"),
        ("·s-", "s-"),
        ("⋅s-", "s-"),
        (".s-", "s-"),
        ("/(ms2)", "/ms2"),
    ] {
        plain = plain.replace(spelling, usual);
    }
    plain
}

/// The units that a word may stand for that is none of them: those with a spelling of three letters and more that it
/// contains or is part of. For messages.
pub fn near(symbol: &str, dimension: Dimension) -> Vec<&'static str> {
    let word = squeeze(symbol).to_lowercase();
    let letters = |text: &str| text.chars().filter(|c| c.is_alphanumeric()).collect::<String>();
    let word = letters(&word);
    let is_near = |spelling: &&&str| {
        let own = letters(&squeeze(spelling).to_lowercase());
        own == word || (own.len() > 2 && (word.contains(&own) || own.contains(&word) && word.len() > 2))
    };
    let of = UNITS.iter().filter(|(_, d, _)| *d == dimension);
    of.filter(|(spellings, ..)| spellings.iter().any(|s| is_near(&s))).map(|(spellings, ..)| spellings[0]).collect()
}

/// The spellings of [`UNITS`] as [`squeeze`] writes them, in the order of the table.
static SQUEEZED: LazyLock<Vec<(String, Dimension, f64)>> = LazyLock::new(|| {
    let spellings_of = |(spellings, dimension, factor): &(&[&str], Dimension, f64)| {
        spellings.iter().map(|spelling| (squeeze(spelling), *dimension, *factor)).collect::<Vec<_>>()
    };
    UNITS.iter().flat_map(spellings_of).collect()
});

/// The units that `symbol` may stand for, with their factors to SI, in the order of the table.
fn units_of(symbol: &str) -> impl Iterator<Item = (Dimension, f64)> {
    let symbol = squeeze(symbol);
    SQUEEZED
        .iter()
        .filter(move |(spelling, ..)| *spelling == symbol)
        .map(|(_, dimension, factor)| (*dimension, *factor))
}

/// The factor that takes a value in `symbol` to SI, if `symbol` is a unit of `dimension`.
///
/// ```
/// use crumple_signal::{unit::{factor, Dimension}, QuantityKind};
/// assert_eq!(factor("g", Dimension::Signal(QuantityKind::Acceleration)), Some(9.80665));
/// assert_eq!(factor("g", Dimension::Mass), None);
/// ```
pub fn factor(symbol: &str, dimension: Dimension) -> Option<f64> {
    units_of(symbol).find(|(d, _)| *d == dimension).map(|(_, factor)| factor)
}

/// A symbol without the brackets around it: `[g]` is `g`, `(m/s^2` is `m/s^2`; `m/(s*s)` stays, its bracket belongs to
/// the unit.
pub fn without_brackets(symbol: &str) -> &str {
    let mut symbol = symbol.trim();
    loop {
        let opens = symbol.starts_with(['[', '(', '{']);
        let closes = symbol.ends_with([']', ')', '}']);
        let depth = |text: &str| {
            text.chars().fold(0_i32, |depth, c| match c {
                '[' | '(' | '{' => depth + 1,
                ']' | ')' | '}' => depth - 1,
                _ => depth,
            })
        };
        // Brackets are one byte long.
        symbol = if opens && closes && opening_bracket(symbol) == Some(0) {
            symbol[1..symbol.len() - 1].trim()
        } else if opens && depth(symbol) > 0 {
            symbol[1..].trim()
        } else if closes && depth(symbol) < 0 {
            symbol[..symbol.len() - 1].trim()
        } else {
            return symbol;
        };
    }
}

/// Where the bracket stands that the last character of a text closes; `None` if it closes none.
///
/// ```
/// use crumple_signal::unit::opening_bracket;
/// assert_eq!(opening_bracket("Acc (m/(s*s))"), Some(4));
/// assert_eq!(opening_bracket("Acc"), None);
/// ```
pub fn opening_bracket(text: &str) -> Option<usize> {
    let close = text.chars().next_back()?;
    let open = match close {
        ']' => '[',
        ')' => '(',
        '}' => '{',
        _ => return None,
    };
    let mut depth = 0_usize;
    for (at, c) in text.char_indices().rev() {
        if c == close {
            depth += 1;
        } else if c == open {
            depth -= 1;
            if depth == 0 {
                return Some(at);
            }
        }
    }
    None
}

/// The signal quantity and factor of a unit found in a file, e.g. `G'S` or `km/h`.
pub fn signal_unit(symbol: &str) -> Option<(QuantityKind, f64)> {
    units_of(symbol).find_map(|(dimension, factor)| match dimension {
        Signal(kind) => Some((kind, factor)),
        _ => None,
    })
}

/// The usual spellings of a dimension's units, for messages: `kg, t, lb`.
pub fn choices(dimension: Dimension) -> String {
    let names: Vec<&str> = UNITS.iter().filter(|(_, d, _)| *d == dimension).map(|(s, _, _)| s[0]).collect();
    names.join(", ")
}

/// Why a typed value cannot be taken.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum UnitError {
    /// A number without a unit.
    #[error("{text:?} has no unit: write a {dimension}, e.g. {text} {example} (units: {choices})")]
    Bare {
        /// What was typed.
        text: String,
        /// What is needed.
        dimension: &'static str,
        /// The unit that people type most.
        example: &'static str,
        /// All known units.
        choices: String,
    },
    /// The unit is unknown or measures something else.
    #[error("{unit:?} in {text:?} is not a unit of {dimension} (units: {choices})")]
    Unit {
        /// What was typed.
        text: String,
        /// Its unit part.
        unit: String,
        /// What is needed.
        dimension: &'static str,
        /// All known units.
        choices: String,
    },
    /// A comma that may part thousands.
    #[error(
        "{text:?} has three digits behind its comma, thousands or decimals: write it with a point, or without comma"
    )]
    Comma {
        /// What was typed.
        text: String,
    },
    /// No number in front.
    #[error("{text:?} does not start with a finite number")]
    Number {
        /// What was typed.
        text: String,
    },
}

/// Reads a value with its unit, such as `35 km/h`, `873kg`, `0s`, and returns it in SI.
///
/// A bare number is refused, `0` included: [`UnitError::Bare`].
pub fn parse_value(text: &str, dimension: Dimension) -> Result<f64, UnitError> {
    let trimmed = text.trim();
    // The number ends before the first letter that is not part of an exponent.
    let mut end = 0;
    let bytes = trimmed.as_bytes();
    let digits_after = |from: usize| bytes.iter().skip(from).take_while(|c| c.is_ascii_digit()).count();
    while end < bytes.len() {
        let c = bytes[end];
        let exponent = matches!(c, b'e' | b'E')
            && end > 0
            && bytes.get(end + 1).is_some_and(|n| {
                n.is_ascii_digit() || (matches!(n, b'+' | b'-') && bytes.get(end + 2).is_some_and(u8::is_ascii_digit))
            });
        // `57,1 km/h`; three digits behind it may be thousands.
        let decimal_comma = c == b',' && !trimmed[..end].contains([',', '.']) && digits_after(end + 1) > 0;
        let sign_in_exponent = matches!(c, b'+' | b'-') && end > 0 && matches!(bytes[end - 1], b'e' | b'E');
        if c.is_ascii_digit()
            || c == b'.'
            || decimal_comma
            || exponent
            || sign_in_exponent
            || (matches!(c, b'+' | b'-') && end == 0)
        {
            end += 1;
        } else {
            break;
        }
    }
    let (number, unit) = (&trimmed[..end], trimmed[end..].trim());
    let is_of_thousands =
        |comma: usize| digits_after(comma + 1) == 3 && number[..comma].trim_start_matches(['+', '-']) != "0";
    if number.find(',').is_some_and(is_of_thousands) {
        return Err(UnitError::Comma { text: text.to_owned() });
    }
    let number: f64 = match number.replace(',', ".").parse::<f64>() {
        Ok(x) if x.is_finite() => x,
        _ => return Err(UnitError::Number { text: text.to_owned() }),
    };
    if unit.is_empty() {
        return Err(UnitError::Bare {
            text: trimmed.to_owned(),
            dimension: dimension.name(),
            example: dimension.usual_unit(),
            choices: choices(dimension),
        });
    }
    match factor(unit, dimension) {
        Some(factor) => Ok(number * factor),
        None => Err(UnitError::Unit {
            text: trimmed.to_owned(),
            unit: unit.to_owned(),
            dimension: dimension.name(),
            choices: choices(dimension),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEED: Dimension = Signal(Q::Velocity);

    #[test]
    fn reads_values_with_and_without_a_blank() {
        assert_eq!(parse_value("873kg", Mass), Ok(873.0));
        assert_eq!(parse_value(" 1.5e3 kg ", Mass), Ok(1500.0));
        assert_eq!(parse_value("36km/h", SPEED), Ok(10.0));
        assert_eq!(parse_value("-20 ms", Time), Ok(-0.02));
        assert_eq!(parse_value("30 mph", SPEED), Ok(13.4112));
        assert_eq!(parse_value("37,8km/h", SPEED), parse_value("37.8km/h", SPEED));
        assert!(matches!(parse_value("1,719 kg", Mass), Err(UnitError::Comma { .. })));
        assert_eq!(parse_value("0,125 m", Signal(Q::Displacement)), Ok(0.125));
        assert!(parse_value("1,2,3 kg", Mass).is_err() && parse_value("5, kg", Mass).is_err());
    }

    #[test]
    fn springs_and_dampers_are_typed_in_the_units_of_the_trade() {
        assert_eq!(parse_value("350 kN/m", Stiffness), Ok(350e3));
        assert_eq!(parse_value("350N/mm", Stiffness), Ok(350e3));
        assert_eq!(parse_value("20 kN s/m", Damping), Ok(20e3));
        assert_eq!(parse_value("8 N*s/mm", Damping), Ok(8e3));
        assert!(matches!(parse_value("20 kN/m", Damping), Err(UnitError::Unit { .. })));
        // A stiffness a width is a pressure; the slope of a speed over a length a frequency.
        assert_eq!(parse_value("400 kN/m²", Signal(Q::Pressure)), Ok(400e3));
        assert_eq!(parse_value("1 lb/in", Stiffness), parse_value("1 lbf/in", Stiffness));
        assert_eq!(parse_value("25/s", Frequency), Ok(25.0));
    }

    #[test]
    fn units_of_simulations_loggers_and_spreadsheets_are_known() {
        let acceleration = |symbol| factor(symbol, Signal(Q::Acceleration));
        for symbol in ["mm/ms^2", "mm/ms²", "mm/ms2", "mm/ms**2", "mm / ms^2"] {
            assert_eq!(acceleration(symbol), Some(1e3), "{symbol}");
        }
        assert_eq!(
            (acceleration("m/ms^2"), acceleration("m/s**2"), acceleration("cm/s²")),
            (Some(1e6), Some(1.0), Some(1e-2))
        );
        assert_eq!(["ns", "min", "h", "days"].map(|s| factor(s, Time)), [1e-9, 60.0, 3600.0, 86_400.0].map(Some));
    }

    #[test]
    fn brackets_around_a_symbol_go_and_its_own_stay() {
        for (written, symbol) in [
            ("[g]", "g"),
            (" ( m/s^2 ) ", "m/s^2"),
            ("m/(s*s)", "m/(s*s)"),
            ("(m/(s*s))", "m/(s*s)"),
            ("[m/(s^2)]", "m/(s^2)"),
            ("[g", "g"),
            ("g)", "g"),
            ("(a)/(b)", "(a)/(b)"),
            ("[]", ""),
            ("", ""),
        ] {
            assert_eq!(without_brackets(written), symbol, "{written}");
        }
        assert_eq!(opening_bracket("a) b)"), None);
    }

    #[test]
    fn asks_back_for_a_missing_unit() {
        let error = parse_value("35", SPEED).unwrap_err();
        assert_eq!(
            error.to_string(),
            "\"35\" has no unit: write a speed, e.g. 35 km/h (units: m/s, km/h, mph, mm/s, ft/s)"
        );
    }

    #[test]
    fn refuses_the_wrong_dimension_and_no_number() {
        assert!(matches!(parse_value("35 kg", SPEED), Err(UnitError::Unit { .. })));
        assert!(matches!(parse_value("kg", Mass), Err(UnitError::Number { .. })));
        assert!(matches!(parse_value("nan kg", Mass), Err(UnitError::Number { .. })));
    }

    #[test]
    fn a_spelling_names_one_unit_per_dimension() {
        for (i, (spellings, dimension, _)) in UNITS.iter().enumerate() {
            for (other, other_dimension, _) in &UNITS[i + 1..] {
                assert!(
                    dimension != other_dimension || !spellings.iter().any(|s| other.contains(s)),
                    "{spellings:?} and {other:?}"
                );
            }
        }
    }
}

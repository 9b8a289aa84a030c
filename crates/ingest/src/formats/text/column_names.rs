//! What the name of a column says: unit, axis, filter class, kind of quantity.

use crumple_signal::unit::{self, Dimension, choices};
use crumple_signal::{Axis, QuantityKind};

use crate::error::Question;
use crate::formats::iso13499;
use crate::recording::scale::of_sensor;
use crate::time::LabelUnit;
use crate::{IngestError, Place, Result};

#[derive(Debug, Clone, PartialEq)]
pub enum Unit {
    Unstated,
    /// Of time, with its factor to s.
    Time(f64),
    /// Of a measured quantity, with its factor to SI.
    Signal(QuantityKind, f64),
    /// Something in brackets that is no unit known here.
    Unknown(String),
}

pub const ACCELERATION: Dimension = Dimension::Signal(QuantityKind::Acceleration);
const VELOCITY: Dimension = Dimension::Signal(QuantityKind::Velocity);

impl Unit {
    /// As that of times.
    pub fn of_times(&self) -> LabelUnit {
        match self {
            Self::Unstated => LabelUnit::Unstated,
            Self::Time(factor) => LabelUnit::Time(*factor),
            Self::Signal(..) | Self::Unknown(_) => LabelUnit::Other,
        }
    }

    /// It is stated and one known here.
    pub fn is_known(&self) -> bool {
        matches!(self, Self::Time(_) | Self::Signal(..))
    }

    /// The refusal of a channel, `id`, whose acceleration is in this unit, which is not known; it may be the reading of
    /// a sensor.
    pub fn refuse(&self, place: Place, id: &str, hint: &str) -> IngestError {
        let found = match self {
            Self::Unknown(symbol) => format!("unit {symbol:?} is not known"),
            _ => "no unit is stated".to_owned(),
        };
        let expected = format!("a unit of acceleration: {}", choices(ACCELERATION));
        let hint = format!("{hint}; of volts or counts {}", of_sensor(id));
        IngestError::content(place, found, expected, hint).asking(Question::Unit)
    }
}

/// The quantity and the factor to SI of a unit that a person states by `from`: of acceleration or velocity, of speed
/// alone where a change of it is read.
pub fn stated_unit(file: &str, symbol: &str, from: &str, is_of_speed: bool) -> Result<(QuantityKind, f64)> {
    let (dimension, what, hint) = if is_of_speed {
        (VELOCITY, "speed", "use --unit km/h or --unit mph")
    } else {
        (ACCELERATION, "acceleration", "use --unit g or --unit m/s^2; of a velocity --unit m/s or --unit km/h")
    };
    let of = |quantity: QuantityKind| Some((quantity, unit::factor(symbol, Dimension::Signal(quantity))?));
    let is_allowed = |(quantity, _): &(QuantityKind, f64)| !is_of_speed || *quantity == QuantityKind::Velocity;
    let known = of(QuantityKind::Acceleration).or_else(|| of(QuantityKind::Velocity)).filter(is_allowed);
    let found = || format!("{symbol:?}, stated by {from}, is no unit of {what}");
    let expected = || format!("one of {}", choices(dimension));
    known.ok_or_else(|| IngestError::content(file, found(), expected(), hint))
}

/// `Acceleration [m/s^2]`, `a (g)`, `acceleration(g)`, `time_s`, `accel_m_per_s2`, `Beschleunigung in g`: the name
/// without the bracket, and the unit.
pub fn split_unit(title: &str) -> (String, Unit) {
    let title = title.trim();
    if let Some(start) = unit::opening_bracket(title) {
        // `time[0]`: a number among several, and no unit.
        if title[start + 1..title.len() - 1].bytes().all(|b| b.is_ascii_digit()) {
            return (title.to_owned(), Unit::Unstated);
        }
        let unit = symbol(&title[start + 1..title.len() - 1], title);
        // `Acc in m/(s*s)`: the bracket belongs to the unit.
        let within = title[..start].ends_with('/').then(|| unbracketed(title));
        if let Some(found) = within.filter(|(_, unit)| unit.is_known()) {
            return found;
        }
        let name = title[..start].trim();
        let name = if name.is_empty() { title } else { name };
        return (name.trim_end_matches([',', '_', '-', '/']).trim().to_owned(), unit);
    }
    unbracketed(title)
}

/// The name and the unit of a title that does not end in a unit in brackets.
fn unbracketed(title: &str) -> (String, Unit) {
    for separator in [" in ", " / ", " - ", ", "] {
        if let Some((name, rest)) = title.rsplit_once(separator) {
            let unit = symbol(rest, title);
            if unit.is_known() {
                return (name.trim().to_owned(), unit);
            }
        }
    }
    // `accel_m_per_s2` before `accel_m_per` + `s2`: the longest suffix that is a unit.
    for (at, _) in title.match_indices('_') {
        let suffix = &title[at + 1..];
        let spelled = suffix.replace("_per_", "/").replace("per_", "/").replace("_s2", "/s2");
        let unit = symbol(&spelled, title);
        if at > 0 && unit.is_known() {
            return (title.to_owned(), unit);
        }
        if at > 0 && is_kg(suffix) && names_acceleration(title) {
            return (title.to_owned(), Unit::Unknown(suffix.to_owned()));
        }
    }
    // `Time s`, `accel g`: the last word, if the words before name the same kind of thing.
    if let Some((name, last)) = title.rsplit_once(' ') {
        let unit = symbol(last, title);
        let fits = match unit {
            Unit::Time(_) => is_time_name(name),
            Unit::Signal(QuantityKind::Acceleration, _) => names_acceleration(name),
            _ => false,
        };
        if fits {
            return (name.trim().to_owned(), unit);
        }
    }
    // `seconds_elapsed`
    let of_word = |word: &str| unit::factor(word, Dimension::Time).filter(|_| word.len() > 1);
    match title.split(['_', ' ']).find_map(of_word).filter(|_| is_time_name(title)) {
        Some(factor) => (title.to_owned(), Unit::Time(factor)),
        None => (title.to_owned(), Unit::Unstated),
    }
}

/// A unit by its symbol. In a column named for time, `m` and `s` are not lengths.
pub fn symbol(text: &str, title: &str) -> Unit {
    let text = text.trim();
    if text.is_empty() {
        return Unit::Unstated;
    }
    // `min` is the least one, too, and `h` and `d` are letters: they are units in a column that is named for time.
    if let Some(factor) = unit::factor(text, Dimension::Time).filter(|f| *f < 2.0 || is_time_name(title)) {
        return Unit::Time(factor);
    }
    if is_kg(text) && names_acceleration(title) {
        return Unit::Unknown(text.to_owned());
    }
    match unit::signal_unit(text) {
        Some((kind, factor)) => Unit::Signal(kind, factor),
        None => Unit::Unknown(text.to_owned()),
    }
}

pub fn signal(text: &str) -> Unit {
    unit::signal_unit(text).map_or(Unit::Unstated, |(kind, factor)| Unit::Signal(kind, factor))
}

/// Whether a symbol is `kg`, which in a column of acceleration is kilo-g.
pub fn is_kg(text: &str) -> bool {
    text.trim().eq_ignore_ascii_case("kg")
}

/// Whether words name acceleration: `accel_g`, `Deceleration`, `deacceleration`, `Beschleunigung`, `Verzögerung`,
/// `a`, or a channel code.
pub fn names_acceleration(text: &str) -> bool {
    let lower = text.to_lowercase();
    ["acc", "decel", "beschl", "verzög", "verzoeg"].iter().any(|part| lower.contains(part))
        || {
            let mut words = lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
            match words.next() {
                Some("a" | "ax" | "ay" | "az") => true,
                // Linear acceleration, and its peak, of a head.
                Some("la" | "pla") => words.next().is_some_and(|word| axis(word).is_some()),
                _ => false,
            }
        }
        || iso13499::is_acceleration(text)
}

/// Whether a header cell names time: `time_s`, `Zeit`, `temps`, `t`, `t [ms]`, `t(s)`, `seconds_elapsed`, `UTC`.
pub fn is_time_name(text: &str) -> bool {
    const STARTS: [&str; 12] = [
        "time", "zeit", "temps", "tempo", "tiempo", "uhrzeit", "elapsed", "seconds", "millis", "utc", "datetime",
        "date/",
    ];
    let lower = text.trim().to_lowercase();
    STARTS.iter().any(|word| lower.starts_with(word))
        || lower.ends_with("elapsed")
        || lower == "t"
        || lower
            .strip_prefix('t')
            .is_some_and(|rest| rest.trim_start().starts_with(['[', '(', '/', '{']) || rest.starts_with('_'))
}

/// Whether a header cell names a count of the rows: `Sample`, `Index`, `#`, `No.`, `Sample number`, `lfd. Nr.`
pub fn is_counter_name(text: &str) -> bool {
    const COUNTED: &str = "sample samples data datapoint point points row line frame record scan step item \
        messpunkt messwert punkt zeile lfd laufende count counter";
    const NUMBER: [&str; 11] = ["", "no", "nr", "num", "number", "nummer", "index", "idx", "id", "count", "#"];
    let (name, unit) = split_unit(text);
    let folded: String =
        name.to_lowercase().chars().filter(|c| c.is_alphanumeric() || matches!(c, '#' | '№')).collect();
    let folded = folded.replace('№', "no");
    let is_named = matches!(folded.as_str(), "i" | "n" | "k")
        || COUNTED.split(' ').chain([""]).any(|of| folded.strip_prefix(of).is_some_and(|rest| NUMBER.contains(&rest)));
    is_named && !folded.is_empty() && !unit.is_known()
}

/// The axis that a name states: `ax`, `accel_x`, `Acc X (g)`, `accX`, `LinAccX`.
pub fn axis(name: &str) -> Option<Axis> {
    let axis_of_word = |word: &str| match word {
        "x" | "ax" | "accx" | "accelx" | "xg" | "longitudinal" => Some(Axis::X),
        "y" | "ay" | "accy" | "accely" | "yg" | "lateral" => Some(Axis::Y),
        "z" | "az" | "accz" | "accelz" | "zg" | "vertical" => Some(Axis::Z),
        "resultant" | "res" => Some(Axis::Resultant),
        _ => None,
    };
    let of_words = |text: &str| text.to_lowercase().split(|c: char| !c.is_alphanumeric()).find_map(axis_of_word);
    // A capital behind a small letter begins a word.
    let mut apart = String::new();
    for c in name.chars() {
        let begins = c.is_uppercase() && apart.ends_with(char::is_lowercase);
        apart.extend(begins.then_some(' '));
        apart.push(c);
    }
    of_words(name).or_else(|| of_words(&apart))
}

/// The channel frequency class that a name states: `accel_cfc60`, `CFC 180`.
pub fn cfc(name: &str) -> Option<u16> {
    let lower = name.to_lowercase();
    let digits: String = lower
        .split_once("cfc")?
        .1
        .trim_start_matches([' ', '_', '-'])
        .chars()
        .take_while(char::is_ascii_digit)
        .collect();
    digits.parse().ok().filter(|class| matches!(class, 60 | 180 | 600 | 1000))
}

/// `Delta-V, longitudinal`, `Longitudinal dv`, `velocity change`.
pub fn names_velocity_change(title: &str) -> bool {
    let letters: String = title.to_lowercase().chars().filter(|c| c.is_alphanumeric() || *c == '\u{394}').collect();
    ["deltav", "velocitychange", "changeofvelocity", "\u{394}v"].iter().any(|word| letters.contains(word))
        || letters == "dv"
}

#[cfg(test)]
mod tests {
    use super::*;

    const G: Unit = Unit::Signal(QuantityKind::Acceleration, 9.806_65);

    #[test]
    fn units_stand_in_brackets_suffixes_and_words() {
        let metre = Unit::Signal(QuantityKind::Acceleration, 1.0);
        let metre_again = metre.clone();
        for (name, unit) in [
            ("accel_g", G),
            ("a (g)", G),
            ("acceleration(g)", G),
            ("Beschleunigung in g", G),
            ("Accel - g", G),
            ("acc g", G),
            ("Acceleration [m/s^2]", metre.clone()),
            ("accel_m_per_s2", metre.clone()),
            ("accel_m_s2", metre),
            ("speed_km_per_h", Unit::Signal(QuantityKind::Velocity, 1.0 / 3.6)),
            ("time_s", Unit::Time(1.0)),
            ("t [ms]", Unit::Time(1e-3)),
            ("Time ms", Unit::Time(1e-3)),
            ("Acc (m/(s*s))", metre_again.clone()),
            ("Acc [m/(s^2)]", metre_again.clone()),
            ("Acc in m/(s*s)", metre_again.clone()),
            ("Acc m/(s*s)", metre_again),
            ("accel", Unit::Unstated),
            ("x [furlong]", Unit::Unknown("furlong".to_owned())),
            ("time[0]", Unit::Unstated),
        ] {
            assert_eq!(split_unit(name).1, unit, "{name}");
        }
    }

    #[test]
    fn words_tell_axis_class_and_kind() {
        assert_eq!(axis("accel_x_g"), Some(Axis::X));
        assert_eq!(axis("ay (g)"), Some(Axis::Y));
        assert_eq!(
            ["LinAccX", "PLA_z", "Head Y", "LinAccRes"].map(axis),
            [Axis::X, Axis::Z, Axis::Y, Axis::Resultant].map(Some)
        );
        assert_eq!(axis("accel_g"), None);
        assert_eq!(cfc("accel_cfc60_g"), Some(60));
        assert_eq!(cfc("accel CFC 61"), None);
        assert!(names_acceleration("deacceleration") && names_acceleration("a [g]") && !names_acceleration("force"));
        assert!(
            is_time_name("t(s)")
                && is_time_name("Zeit [ms]")
                && !is_time_name("trunk_g")
                && !is_time_name("temperature")
        );
        for name in ["Sample", "Index", "#", "No.", "Nr", "Sample no.", "sample_number", "Sample [-]", "lfd. Nr.", "i"]
        {
            assert!(is_counter_name(name), "{name}");
        }
        for name in ["Sample time [s]", "index_g", "accel", "t", "Messung", "Noise", "data [g]", "", "node"] {
            assert!(!is_counter_name(name), "{name}");
        }
    }
}

//! What a simulation must keep: `crush<=20mm`, one by one or in a file.

use crumple_signal::value::{Length, Level, Share, Speed, Time};
use serde::Serialize;

/// How the values of a name are typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Typed {
    Length,
    Time,
    Speed,
    Acceleration,
    Percent,
    Number,
}

/// Every name, how its value is typed, and what it is.
const NAMES: [(&str, Typed, &str); 18] = [
    ("crush", Typed::Length, "dynamic crush less that of the test"),
    ("time-of-crush", Typed::Time, "its time less that of the test"),
    ("delta-v", Typed::Speed, "change of velocity less that of the test"),
    ("peak", Typed::Acceleration, "peak deceleration less that of the test"),
    ("olc", Typed::Acceleration, "OLC less that of the test"),
    ("restitution", Typed::Number, "restitution less that of the test"),
    ("velocity-iso", Typed::Number, "ISO/TS 18571 of the velocity"),
    ("acceleration-iso", Typed::Number, "ISO/TS 18571 of the acceleration"),
    ("velocity-cora", Typed::Number, "CORA of the velocity"),
    ("acceleration-cora", Typed::Number, "CORA of the acceleration"),
    ("wall-force", Typed::Percent, "largest difference of the wall force in a segment"),
    ("deceleration", Typed::Percent, "largest difference of the deceleration in a segment"),
    ("energy-ratio", Typed::Number, "total over initial and external energy, where farthest from 1"),
    ("hourglass", Typed::Percent, "hourglass over internal energy, peaks"),
    ("contact-energy", Typed::Percent, "negative contact energy over the initial energy"),
    ("damping", Typed::Percent, "damping energy over the initial energy"),
    ("added-mass", Typed::Percent, "added mass"),
    ("wall-impulse", Typed::Number, "impulse of the wall over the change of momentum"),
];

/// A limit of a number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Requirement {
    /// Its name.
    pub name: &'static str,
    /// The least value that it may have, SI.
    pub at_least: Option<f64>,
    /// The largest.
    pub at_most: Option<f64>,
    /// As it was typed.
    pub text: String,
    /// Where it stands: `--require`, or the name of a file.
    pub source: String,
}

impl Requirement {
    /// Reads `NAME<=VALUE` or `NAME>=VALUE`, the value with its unit.
    pub fn read(text: &str, source: &str) -> Result<Self, String> {
        let text = text.trim();
        let is_most = text.contains("<=");
        let (name, value) = text
            .split_once(if is_most { "<=" } else { ">=" })
            .ok_or_else(|| format!("{text:?}: expected NAME<=VALUE or NAME>=VALUE, such as crush<=20mm"))?;
        let known = NAMES.iter().find(|(known, ..)| *known == name.trim());
        let (name, typed, _) = known.ok_or_else(|| {
            let names: Vec<&str> = NAMES.iter().map(|(name, ..)| *name).collect();
            format!("unknown number {:?}, expected one of {}", name.trim(), names.join(", "))
        })?;
        let value = typed.read(value.trim()).map_err(|problem| format!("{text}: {problem}"))?;
        let (at_least, at_most) = if is_most { (None, Some(value)) } else { (Some(value), None) };
        Ok(Self { name, at_least, at_most, text: text.to_owned(), source: source.to_owned() })
    }

    /// Reads a file: a requirement a line, `#` before a comment.
    pub fn read_file(text: &str, name: &str) -> Result<Vec<Self>, String> {
        let lines = (1..).zip(text.lines().map(|line| line.split('#').next().unwrap_or_default().trim()));
        let of_line = |(number, line): (usize, &str)| {
            Self::read(line, name).map_err(|problem| format!("{name}, line {number}: {problem}"))
        };
        lines.filter(|(_, line)| !line.is_empty()).map(of_line).collect()
    }

    /// Whether a value keeps it. One that is not known does not.
    pub fn is_held(&self, value: Option<f64>) -> bool {
        value.is_some_and(|x| self.at_least.is_none_or(|least| x >= least) && self.at_most.is_none_or(|most| x <= most))
    }
}

/// The names and what they are, for the help.
pub fn help() -> String {
    let lines: Vec<String> = NAMES.iter().map(|(name, _, what)| format!("  {name:<18}{what}")).collect();
    format!(
        "Numbers of --require and --limits (differences by their magnitude):\n{}\n\nA file of limits has one a line, \
         such as hourglass<=5%.\n\nExit codes: 0 compared and every requirement held, 1 one is not, 2 usage, 3 input \
         refused, 4 no comparison possible. Without --require a bad model is 0.",
        lines.join("\n")
    )
}

impl Typed {
    fn read(self, text: &str) -> Result<f64, String> {
        let said = |error: &dyn std::fmt::Display| error.to_string();
        let (_, _, unit) = self.unit();
        if !unit.is_empty() && text.parse::<f64>().is_ok() {
            return Err(format!("{text:?} has no unit: write {text}{unit}"));
        }
        match self {
            Self::Length => text.parse::<Length>().map(Length::si).map_err(|error| said(&error)),
            Self::Time => text.parse::<Time>().map(Time::si).map_err(|error| said(&error)),
            Self::Speed => text.parse::<Speed>().map(Speed::si).map_err(|error| said(&error)),
            Self::Acceleration => text.parse::<Level>().map(Level::si).map_err(|error| said(&error)),
            Self::Percent => text.parse::<Share>().map(Share::si).map_err(|error| said(&error)),
            Self::Number => {
                let number = text.parse::<f64>().ok().filter(|x| x.is_finite());
                number.ok_or_else(|| format!("{text:?} is no number"))
            }
        }
    }

    /// Factor from SI, decimals and unit for people; nothing of a plain number.
    fn unit(self) -> (f64, usize, &'static str) {
        use crate::drawing::numbers::{G_PER_M_PER_S2, KM_PER_H_PER_M_PER_S, MILLI};
        match self {
            Self::Length => (MILLI, 1, "mm"),
            Self::Time => (MILLI, 1, "ms"),
            Self::Speed => (KM_PER_H_PER_M_PER_S, 2, "km/h"),
            Self::Acceleration => (G_PER_M_PER_S2, 1, "g"),
            Self::Percent => (100.0, 1, "%"),
            Self::Number => (1.0, 3, ""),
        }
    }

    /// A value for people.
    fn shown(self, value: f64) -> String {
        let (factor, places, unit) = self.unit();
        crate::words::quantity(factor * value, places, unit)
    }
}

/// A value by the unit of a name; empty for a name that is none.
pub fn shown(name: &str, value: f64) -> String {
    NAMES.iter().find(|(known, ..)| *known == name).map_or_else(String::new, |(_, typed, _)| typed.shown(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_requirement_is_a_name_and_a_value_with_its_unit() {
        let crush = Requirement::read("crush <= 20mm", "--require").unwrap();
        assert!(crush.is_held(Some(0.02)) && !crush.is_held(Some(0.0625)) && !crush.is_held(None));
        assert_eq!(shown("crush", 0.0625), "62.5\u{a0}mm");
        let rating = Requirement::read("velocity-iso>=0.9", "x").unwrap();
        assert!(rating.is_held(Some(0.905)) && !rating.is_held(Some(0.84)));
        let hourglass = Requirement::read("hourglass<=5%", "x").unwrap();
        assert_eq!((hourglass.at_most, shown("hourglass", 0.0204)), (Some(0.05), "2.0\u{a0}%".to_owned()));
        for (text, problem) in [
            ("crush<20mm", "expected NAME<=VALUE"),
            ("mass<=2kg", "unknown number \"mass\", expected one of crush,"),
            ("crush<=20", "crush<=20: \"20\" has no unit: write 20mm"),
            ("olc<=x", "olc<=x:"),
            ("velocity-iso>=nan", "is no number"),
        ] {
            let said = Requirement::read(text, "x").unwrap_err();
            assert!(said.contains(problem), "{said}");
        }
    }

    #[test]
    fn a_file_of_limits_has_one_a_line() {
        let read = Requirement::read_file("# ours\ncrush<=20mm\n\nenergy-ratio>=0.98 # tight\n", "l.txt").unwrap();
        assert_eq!(read.iter().map(|one| one.name).collect::<Vec<_>>(), ["crush", "energy-ratio"]);
        let problem = Requirement::read_file("crush<=20mm\nx<=1", "l.txt").unwrap_err();
        assert!(problem.starts_with("l.txt, line 2: unknown number"), "{problem}");
    }
}

//! What a note concerns, and how much it changes there.

use std::fmt;
use std::str::FromStr;

/// What a note concerns: one of the things that a report shows.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum About {
    /// The channel that the crash is read from: whether it is the right one, its sign, its unit, its samples.
    Pulse,
    /// The mass of the vehicle.
    Mass,
    /// The impact speed.
    ImpactSpeed,
    /// Time zero and the time axis.
    Time,
    /// Velocity, crush and the numbers made from them.
    Motion,
    /// A lumped model or one of its candidates, by name or id.
    Model(String),
    /// What is predicted.
    Predictions,
    /// Criteria of occupants.
    Occupants,
    /// Force on the barrier.
    WallForce,
    /// Identified models of inputs and outputs.
    IdentifiedModels,
    /// An identification method that gave no model, or not all that were asked of it, by name.
    Method(String),
    /// Another channel than the pulse, by id.
    Channel(String),
    /// The file as it was read.
    Record,
}

/// Words of the kinds that need no name.
const PLAIN: [(About, &str); 10] = [
    (About::Pulse, "pulse"),
    (About::Mass, "mass"),
    (About::ImpactSpeed, "impact-speed"),
    (About::Time, "time"),
    (About::Motion, "motion"),
    (About::Predictions, "predictions"),
    (About::Occupants, "occupants"),
    (About::WallForce, "wall-force"),
    (About::IdentifiedModels, "identified-models"),
    (About::Record, "record"),
];
const MODEL: &str = "model:";
const METHOD: &str = "method:";
const CHANNEL: &str = "channel:";

impl About {
    /// What notes of a stage concern that do not say it.
    pub fn of_stage(stage: &str) -> Self {
        match stage {
            "filter" => Self::Pulse,
            "integrate" => Self::Motion,
            "identify" => Self::IdentifiedModels,
            "parameter-solve" | "simulate" => Self::Model(String::new()),
            "predict" => Self::Predictions,
            _ => Self::Record,
        }
    }
}

/// The text form of records: `pulse`, `model:kelvin/direct-fit/1`, `channel:96`.
impl fmt::Display for About {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Model(name) => write!(f, "{MODEL}{name}"),
            Self::Method(name) => write!(f, "{METHOD}{name}"),
            Self::Channel(id) => write!(f, "{CHANNEL}{id}"),
            plain => f.write_str(PLAIN.iter().find(|(about, _)| about == plain).map_or("record", |(_, word)| word)),
        }
    }
}

/// Text that names nothing a report shows.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not what a note can concern")]
pub struct UnknownAbout(String);

impl FromStr for About {
    type Err = UnknownAbout;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if let Some(name) = text.strip_prefix(MODEL) {
            return Ok(Self::Model(name.to_owned()));
        }
        if let Some(name) = text.strip_prefix(METHOD) {
            return Ok(Self::Method(name.to_owned()));
        }
        if let Some(id) = text.strip_prefix(CHANNEL) {
            return Ok(Self::Channel(id.to_owned()));
        }
        let plain = PLAIN.iter().find(|(_, word)| *word == text).map(|(about, _)| about.clone());
        plain.ok_or_else(|| UnknownAbout(text.to_owned()))
    }
}

/// What becomes of what is shown, if the note is true.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Weight {
    /// It stays within what its interval says, or a part of little interest changes.
    Slight = 1,
    /// Numbers may be off by more than their intervals say.
    Marked = 2,
    /// It may be another thing than it is taken for: wrong channel, sign, unit, mass.
    Decisive = 3,
}

impl Weight {
    /// 1 to 3, as records have it.
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// The weight of a number; what is beyond 3 is decisive, 0 slight.
    pub const fn of_number(number: u8) -> Self {
        match number {
            0 | 1 => Self::Slight,
            2 => Self::Marked,
            _ => Self::Decisive,
        }
    }
}

/// What a note concerns and how much it changes there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bearing {
    /// What it concerns.
    pub about: About,
    /// How much it changes there.
    pub weight: Weight,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_forms_are_read_back() {
        let named = [
            About::Model("kelvin/direct-fit/1".to_owned()),
            About::Method("okid".to_owned()),
            About::Channel("96".to_owned()),
        ];
        for about in PLAIN.iter().map(|(about, _)| about.clone()).chain(named) {
            assert_eq!(about.to_string().parse(), Ok(about));
        }
        assert!("elsewhere".parse::<About>().is_err());
        for weight in [Weight::Slight, Weight::Marked, Weight::Decisive] {
            assert_eq!(Weight::of_number(weight.number()), weight);
        }
    }
}

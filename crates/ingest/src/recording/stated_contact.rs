//! Contact as a person states it: a time, or a rule.

use std::fmt;
use std::str::FromStr;

use crumple_signal::unit::UnitError;
use crumple_signal::value::Time;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// Contact as a person states it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimeZero {
    /// Where the pulse begins.
    Auto,
    /// On the file's time axis.
    At(Time),
}

impl TimeZero {
    /// The time, where one is stated.
    pub fn stated(self) -> Option<Time> {
        match self {
            Self::Auto => None,
            Self::At(time) => Some(time),
        }
    }
}

impl FromStr for TimeZero {
    type Err = UnitError;

    fn from_str(text: &str) -> Result<Self, UnitError> {
        if text.trim() == "auto" { Ok(Self::Auto) } else { text.parse().map(Self::At) }
    }
}

impl fmt::Display for TimeZero {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::At(time) => time.fmt(f),
        }
    }
}

/// How contact is found where no time is stated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ContactRule {
    /// Where the pulse begins, unless the file's t = 0 agrees with that.
    Auto,
    /// At 0 s of the file.
    File,
    /// By threshold.
    Threshold,
    /// By the rule for event data recorders.
    Edr,
    /// From a contact switch: id of its channel.
    Switch(String),
}

impl FromStr for ContactRule {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "auto" => Ok(Self::Auto),
            "file" => Ok(Self::File),
            "threshold" => Ok(Self::Threshold),
            "edr" => Ok(Self::Edr),
            other => match other.strip_prefix("contact:").map(str::trim) {
                Some(id) if !id.is_empty() => Ok(Self::Switch(id.to_owned())),
                _ => Err(format!("unknown rule {text:?}, expected auto, file, threshold, edr or contact:<channel>")),
            },
        }
    }
}

impl fmt::Display for ContactRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::File => f.write_str("file"),
            Self::Threshold => f.write_str("threshold"),
            Self::Edr => f.write_str("edr"),
            Self::Switch(id) => write!(f, "contact:{id}"),
        }
    }
}

macro_rules! as_text {
    ($($name:ident),*) => {$(
        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_str(self)
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                String::deserialize(deserializer)?.parse().map_err(de::Error::custom)
            }
        }
    )*};
}

as_text!(TimeZero, ContactRule);

//! The names that options take, each an enum: one list for flags, pipeline files and the artifact.

use std::fmt;
use std::str::FromStr;

use clap::ValueEnum;
use crumple_signal::value::Time;
use crumple_sysid::{Criterion, InitialConditions, Start, Weighting};
use serde::{Deserialize, Serialize};

/// An enum of names, the first the default; `as` an enum of the library, each variant as the one that it names there.
macro_rules! names {
    ($(#[$doc:meta])* $name:ident: $first:ident $(, $variant:ident)*) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum $name {
            #[default]
            $first,
            $($variant,)*
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.to_possible_value().as_ref().map_or("", |value| value.get_name()))
            }
        }
    };
    ($(#[$doc:meta])* $name:ident as $library:ty: $first:ident = $known:ident $(, $variant:ident = $other:ident)*) => {
        names!($(#[$doc])* $name: $first $(, $variant)*);

        impl From<$name> for $library {
            fn from(named: $name) -> Self {
                match named {
                    $name::$first => Self::$known,
                    $($name::$variant => Self::$other,)*
                }
            }
        }
    };
}

names!(
    /// A method of identification.
    Method: Era, Okid, Tfest, Exponentials, N4sid, Moesp, Cva, Arx, OutputError, Auto
);
names!(
    /// The size of the Hankel matrix of ERA.
    HankelSize: Half, TwiceOrder
);
names!(
    /// The criterion for the number of lags.
    LagCriterion as Criterion: Aicc = Aicc, Bic = Bic
);
names!(
    /// The input between its samples.
    Hold as crumple_sysid::Hold: FirstOrder = First, ZeroOrder = Zero
);
names!(
    /// The motion at the start of the window.
    Initial as InitialConditions: Estimate = Estimate, Zero = Zero, Auto = Auto
);
names!(
    /// A way to starting points of a transfer function.
    StartName as Start: Svf = Svf, Iv = Iv, N4sid = N4sid, Arx = Arx, Integrators = Integrators,
    Random = Random
);
names!(
    /// What a sum of exponentials has at the start of the window.
    Condition: Position, Velocity, Acceleration
);
names!(
    /// A paper whose procedure is followed.
    Paper: Era, CurveFit, Tfest
);

impl Method {
    /// Whether it takes records for impulse responses, and has no input.
    pub fn is_of_free_motion(self) -> bool {
        self == Self::Era
    }

    /// Whether it has a use for inputs.
    pub fn takes_inputs(self) -> bool {
        !matches!(self, Self::Era | Self::Exponentials)
    }

    /// Whether its models predict one step ahead from measured outputs.
    pub fn predicts(self) -> bool {
        matches!(self, Self::Arx | Self::Okid)
    }

    /// The weighting of a subspace method.
    pub fn weighting(self) -> Option<Weighting> {
        match self {
            Self::N4sid => Some(Weighting::N4sid),
            Self::Moesp => Some(Weighting::Moesp),
            Self::Cva => Some(Weighting::Cva),
            _ => None,
        }
    }
}

/// First of the samples kept for validation: a time, or a share of the samples in use.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum ValidateFrom {
    /// This time, s.
    Time(f64),
    /// After this share.
    Share(f64),
}

impl FromStr for ValidateFrom {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some(percent) = text.trim().strip_suffix('%') else {
            return text.parse::<Time>().map(|time| Self::Time(time.si())).map_err(|error| error.to_string());
        };
        let share = percent.trim().parse::<f64>().ok().filter(|percent| *percent > 0.0 && *percent < 100.0);
        share
            .map(|percent| Self::Share(percent / 100.0))
            .ok_or_else(|| format!("validation from {text:?}: a share lies between 0% and 100%, for instance 50%"))
    }
}

impl TryFrom<String> for ValidateFrom {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<ValidateFrom> for String {
    fn from(from: ValidateFrom) -> Self {
        match from {
            ValidateFrom::Time(seconds) => format!("{seconds} s"),
            ValidateFrom::Share(share) => format!("{}%", 100.0 * share),
        }
    }
}

/// Samples by which the inputs act late: a number, or the best of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Delay {
    /// As given.
    Given(u32),
    /// The best from the first to the last.
    Auto(u32, u32),
}

/// Delays that `auto` tries: lags 0 to 20, of which a hold takes one.
const AUTOMATIC_DELAYS: (u32, u32) = (0, 19);

/// Delays of a scan, at most.
const MOST_DELAYS: u32 = 200;

impl FromStr for Delay {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bad = || format!("delay {text:?} is neither a number of samples nor \"auto\" nor a range, as in auto=0-30");
        let Some(range) = text.trim().strip_prefix("auto") else {
            return text.trim().parse().map(Self::Given).map_err(|_| bad());
        };
        if range.is_empty() {
            return Ok(Self::Auto(AUTOMATIC_DELAYS.0, AUTOMATIC_DELAYS.1));
        }
        let (first, last) = range.strip_prefix('=').and_then(|range| range.split_once('-')).ok_or_else(bad)?;
        let number = |text: &str| text.trim().parse::<u32>().map_err(|_| bad());
        let (first, last) = (number(first)?, number(last)?);
        match first <= last && last - first <= MOST_DELAYS {
            true => Ok(Self::Auto(first, last)),
            false => Err(bad()),
        }
    }
}

impl fmt::Display for Delay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Given(samples) => write!(f, "{samples}"),
            Self::Auto(first, last) => write!(f, "auto={first}-{last}"),
        }
    }
}

impl Serialize for Delay {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Given(samples) => serializer.serialize_u32(*samples),
            Self::Auto(..) => serializer.collect_str(self),
        }
    }
}

impl<'de> Deserialize<'de> for Delay {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Written {
            Number(u32),
            Text(String),
        }
        match Written::deserialize(deserializer)? {
            Written::Number(samples) => Ok(Self::Given(samples)),
            Written::Text(text) => text.parse().map_err(serde::de::Error::custom),
        }
    }
}

/// Where free motion starts: at the time of separation, or where the pulse stays under a share of its peak.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum FreeDecay {
    /// The time of the rebound velocity.
    Separation,
    /// This share of the peak.
    Share(f64),
}

impl FreeDecay {
    /// The share; 0 of the separation.
    pub fn share(self) -> f64 {
        match self {
            Self::Separation => 0.0,
            Self::Share(share) => share,
        }
    }
}

impl FromStr for FreeDecay {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "separation" {
            return Ok(Self::Separation);
        }
        let percent = text.strip_suffix('%').and_then(|number| number.trim().parse::<f64>().ok());
        percent
            .filter(|percent| *percent > 0.0 && *percent < 100.0)
            .map(|percent| Self::Share(percent / 100.0))
            .ok_or_else(|| {
                format!("free decay {text:?} is neither \"separation\" nor a share of the peak, for instance 5%")
            })
    }
}

impl TryFrom<String> for FreeDecay {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<FreeDecay> for String {
    fn from(decay: FreeDecay) -> Self {
        match decay {
            FreeDecay::Separation => "separation".to_owned(),
            FreeDecay::Share(share) => format!("{}%", 100.0 * share),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_one_in_flags_and_files() {
        for method in Method::value_variants() {
            let in_file = serde_json::to_value(method).unwrap();
            assert_eq!(in_file, method.to_string());
            assert_eq!(Method::from_str(&method.to_string(), false), Ok(*method));
        }
        for start in StartName::value_variants() {
            assert_eq!(Start::from(*start).name(), start.to_string());
        }
    }

    #[test]
    fn a_delay_is_a_number_or_a_range_and_validation_begins_at_a_time_or_after_a_share() {
        assert_eq!("3".parse(), Ok(Delay::Given(3)));
        assert_eq!("auto".parse(), Ok(Delay::Auto(0, 19)));
        assert_eq!(serde_json::from_str::<Delay>("\"auto=2-9\"").unwrap(), Delay::Auto(2, 9));
        assert_eq!(serde_json::to_string(&Delay::Given(3)).unwrap(), "3");
        for wrong in ["auto=9-2", "auto5", "-1", "auto=0-999"] {
            assert!(wrong.parse::<Delay>().unwrap_err().contains("neither a number"), "{wrong}");
        }
        assert_eq!("50%".parse(), Ok(ValidateFrom::Share(0.5)));
        assert_eq!("100ms".parse(), Ok(ValidateFrom::Time(0.1)));
        assert!("100%".parse::<ValidateFrom>().unwrap_err().contains("between"));
    }

    #[test]
    fn a_free_decay_is_a_share_of_the_peak_or_the_separation() {
        assert_eq!("5%".parse(), Ok(FreeDecay::Share(0.05)));
        assert_eq!(serde_json::from_str::<FreeDecay>("\"separation\"").unwrap(), FreeDecay::Separation);
        assert!("5".parse::<FreeDecay>().unwrap_err().contains("neither"));
    }
}

//! Flags and pipeline keys of the stage.

use std::fmt;
use std::str::FromStr;

use crumple_integrate::{DriftShape, Rule, Start};
use crumple_signal::Uncertain;
use crumple_signal::value::{Length, Level, Share, Speed, Time};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// Flags and keys; what is not given has the default named in its text.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// How samples are summed [default: trapezoid]
    #[arg(long, value_enum)]
    pub rule: Option<Rule>,

    /// Where the integration starts [default: auto]
    #[arg(long, value_enum)]
    pub start: Option<Start>,

    /// Channel to take as the crash pulse, by id, code or a pattern that means one [default: the pulse of the test]
    #[arg(long, value_name = "ID")]
    pub channel: Option<String>,

    /// Further accelerometers to integrate, by id, code or pattern such as '1?VEHC*X?'; all stands for every x
    /// acceleration of the compartment [default: none]
    #[arg(long, value_name = "ID", value_delimiter = ',')]
    pub channels: Vec<String>,

    /// First contact on the record's time axis, e.g. 1.2ms [default: 0 s, as the file has it]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub time_zero: Option<Time>,

    /// How first contact is found: file, threshold (0.5 g for 3 ms), edr (49 CFR 563: 0.8 km/h in 20 ms) or
    /// contact:<channel>, the edge of a contact switch [default: file]
    #[arg(long, value_name = "RULE")]
    pub time_zero_rule: Option<ZeroRule>,

    /// Speed just before contact, e.g. 57.09km/h, instead of the one in the test description
    #[arg(long, value_name = "SPEED")]
    pub impact_speed: Option<Speed>,

    /// Known velocity after separation, e.g. -2.5m/s, or standstill: the drift that brings the pulse there is taken out
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    pub end_velocity: Option<EndVelocity>,

    /// When the known velocity holds, on the record's time axis [default: at the last sample]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub end_time: Option<Time>,

    /// What the drift is taken to be [default: bias]
    #[arg(long, value_enum)]
    pub drift: Option<DriftShape>,

    /// Uncertainty of the impact speed, e.g. "0.1 km/h" (standard deviation) or "0.1 km/h uniform" (half width): events
    /// and metrics get 5-95 % intervals [default: none stated]
    #[arg(long, value_name = "SPEED [normal|uniform]")]
    pub speed_uncertainty: Option<Uncertain<Speed>>,

    /// Uncertainty of the zero level that is left, e.g. "0.05 g uniform" [default: none stated]
    #[arg(long, value_name = "ACCELERATION [normal|uniform]")]
    pub zero_level_uncertainty: Option<Uncertain<Level>>,

    /// Uncertainty of the gain of the channel, e.g. "1 % uniform" [default: none stated]
    #[arg(long, value_name = "PERCENT [normal|uniform]")]
    pub gain_uncertainty: Option<Uncertain<Share>>,

    /// Uncertainty of first contact, e.g. "0.5 ms uniform" [default: none stated]
    #[arg(long, value_name = "TIME [normal|uniform]")]
    pub time_zero_uncertainty: Option<Uncertain<Time>>,

    /// How often the integration is repeated with perturbed inputs, 0 for no intervals [default: 400]
    #[arg(long, value_name = "N")]
    pub uncertainty_replicates: Option<u32>,

    /// Seed of the random numbers of the repetitions [default: 1]
    #[arg(long, value_name = "N")]
    pub uncertainty_seed: Option<u64>,

    /// Load cells of the barrier in the sum of its force [default: valid]
    #[arg(long, value_enum)]
    pub barrier_cells: Option<BarrierCells>,

    /// Metrics of occupants and roadside hardware beside those of the pulse, by group [default: auto]
    #[arg(long, value_enum, value_name = "GROUP", value_delimiter = ',')]
    pub metrics: Vec<MetricGroup>,

    /// Width of the damage, e.g. 1.6m: with the residual crush, CRASH3 stiffness A, B and G [default: as the file
    /// states it]
    #[arg(long, value_name = "LENGTH")]
    pub damage_width: Option<Length>,

    /// Residual crush measured on the vehicle, e.g. 520mm, for CRASH3 [default: as the file states it]
    #[arg(long, value_name = "LENGTH")]
    pub residual_crush: Option<Length>,

    /// Speed of no damage b0 for CRASH3 [default: 2.2352 m/s, 5 mph]
    #[arg(long, value_name = "SPEED")]
    pub no_damage_speed: Option<Speed>,
}

/// Groups of metrics of occupants and of roadside hardware.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum MetricGroup {
    /// Every group whose channels the test has.
    #[default]
    Auto,
    /// Head accelerations: HIC15, HIC36, 3 ms clips; HIC(d) of a free-motion headform.
    Head,
    /// Chest accelerations: 3 ms clips.
    Chest,
    /// Vehicle x and y at the centre of gravity: ASI, OIV, ORA; with the yaw rate THIV and PHD. Asked for by name, the
    /// pulse stands in for a missing x, and a missing y is 0.
    Roadside,
    /// Chest x against the pulse: ride-down.
    RideDown,
    /// None of them.
    None,
}

/// Which load cells are summed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum BarrierCells {
    /// Those that the laboratory marks valid; the others are named.
    #[default]
    Valid,
    /// All with data, as read.
    All,
    /// None: no barrier force.
    None,
}

/// How first contact is found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ZeroRule {
    /// At 0 s of the record.
    File,
    /// By threshold.
    Threshold,
    /// By the rule for event data recorders.
    Edr,
    /// From a contact switch: id of its channel.
    Contact(String),
}

impl FromStr for ZeroRule {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "file" => Ok(Self::File),
            "threshold" => Ok(Self::Threshold),
            "edr" => Ok(Self::Edr),
            other => match other.strip_prefix("contact:").map(str::trim) {
                Some(id) if !id.is_empty() => Ok(Self::Contact(id.to_owned())),
                _ => Err(format!("unknown rule {text:?}, expected file, threshold, edr or contact:<channel>")),
            },
        }
    }
}

impl fmt::Display for ZeroRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => f.write_str("file"),
            Self::Threshold => f.write_str("threshold"),
            Self::Edr => f.write_str("edr"),
            Self::Contact(id) => write!(f, "contact:{id}"),
        }
    }
}

/// A velocity along x, m/s; `standstill` is 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndVelocity(pub Speed);

impl FromStr for EndVelocity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "standstill" => Ok(Self(Speed::from_si(0.0))),
            speed => speed.parse().map(Self).map_err(|error: crumple_signal::unit::UnitError| error.to_string()),
        }
    }
}

impl fmt::Display for EndVelocity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
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

as_text!(ZeroRule, EndVelocity);

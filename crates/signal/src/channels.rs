//! Identity and state of a measuring channel, and its sensitive axis.

use std::fmt;
use std::str::FromStr;

use crate::QuantityKind;

/// Sensitive axis of a sensor, SAE J211-1: X forward, Y to the right, Z down.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Axis {
    /// Longitudinal.
    X,
    /// Lateral.
    Y,
    /// Vertical.
    Z,
    /// Resultant of several axes.
    Resultant,
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::Resultant => "resultant",
        })
    }
}

impl FromStr for Axis {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.to_ascii_lowercase().as_str() {
            "x" => Ok(Self::X),
            "y" => Ok(Self::Y),
            "z" => Ok(Self::Z),
            "resultant" | "r" => Ok(Self::Resultant),
            _ => Err(format!("unknown axis {text:?}, expected x, y, z or resultant")),
        }
    }
}

/// What the laboratory says of a channel's data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ChannelStatus {
    /// Valid as measured, or nothing is said against it.
    Valid,
    /// Computed from other channels.
    Computed,
    /// Questionable, in part or from some time on.
    Questionable,
    /// Failed or meaningless.
    Failed,
    /// Listed, but the sensor was not installed: there is no data and none is missing.
    NotInstalled,
    /// Listed, but its data file is not here.
    Absent,
}

impl ChannelStatus {
    const ALL: [Self; 6] =
        [Self::Valid, Self::Computed, Self::Questionable, Self::Failed, Self::NotInstalled, Self::Absent];

    /// The name used in artifacts.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Valid => "valid",
            Self::Computed => "computed",
            Self::Questionable => "questionable",
            Self::Failed => "failed",
            Self::NotInstalled => "not installed",
            Self::Absent => "absent",
        }
    }

    /// Whether a listing has samples with it.
    pub fn has_data(self) -> bool {
        !matches!(self, Self::NotInstalled | Self::Absent)
    }
}

impl fmt::Display for ChannelStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for ChannelStatus {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|status| status.name() == text)
            .ok_or_else(|| format!("unknown channel status {text:?}"))
    }
}

/// What the location of a sensor begins with that is in or on somebody or something else than the vehicle, lower case.
const ELSEWHERE: [&str; 10] = [
    "driver",
    "front passenger",
    "rear passenger",
    "passenger",
    "occupant",
    "dummy",
    "child",
    "pedestrian",
    "cyclist",
    BARRIER,
];
/// What the location of a load cell of a barrier begins with.
pub const BARRIER: &str = "barrier";

/// Identity and state of one channel. The samples are elsewhere, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Short name, unique in its test: the column name of a table, the curve number of an NHTSA test.
    pub id: String,
    /// Where the sensor sits, in words; empty if unknown.
    pub location: String,
    /// Sensitive axis, if known.
    pub axis: Option<Axis>,
    /// What is measured.
    pub quantity: QuantityKind,
    /// Channel frequency class of the data (60, 180, 600, 1000); `None`: not filtered to a class, or not known.
    pub cfc: Option<u16>,
    /// What the laboratory says of the data.
    pub status: ChannelStatus,
    /// Whether another sensor at the same place is the primary one.
    pub redundant: bool,
    /// Velocity along the sensor axis at time zero, m/s, signed, if known.
    pub initial_velocity_m_per_s: Option<f64>,
    /// The laboratory's remark on this channel.
    pub comment: Option<String>,
    /// Channel code of ISO/TS 13499, as the source writes it or built from its fields.
    pub code: Option<String>,
    /// Transducer: type and serial number as the source gives them.
    pub sensor: Option<String>,
    /// Filter state in words: `CFC 60`, `pre-filtered above CFC 1000`, `low-pass 2800 Hz`.
    pub filter_state: Option<String>,
    /// What the source says of the sign, where it departs from SAE J211 or leaves it open.
    pub polarity: Option<String>,
}

impl Channel {
    /// A valid, unfiltered channel about which nothing else is known.
    pub fn new(id: impl Into<String>, quantity: QuantityKind) -> Self {
        Self {
            id: id.into(),
            location: String::new(),
            axis: None,
            quantity,
            cfc: None,
            status: ChannelStatus::Valid,
            redundant: false,
            initial_velocity_m_per_s: None,
            comment: None,
            code: None,
            sensor: None,
            filter_state: None,
            polarity: None,
        }
    }

    /// Whether gravity may change what it reads: an acceleration, but for one along x or y that is coded as one of a
    /// vehicle's structure, which lies level.
    pub fn may_feel_gravity(&self) -> bool {
        let is_level = matches!(self.axis, Some(Axis::X | Axis::Y));
        let is_of_vehicle = self.code.is_some() && self.may_be_on_vehicle();
        self.quantity == QuantityKind::Acceleration && !(is_level && is_of_vehicle)
    }

    /// Whether it is the force along x of a load cell in a barrier, or of all of them: its location begins with
    /// [`BARRIER`], and its axis is x or not stated.
    pub fn is_wall_force(&self) -> bool {
        self.quantity == QuantityKind::Force
            && self.axis.is_none_or(|axis| axis == Axis::X)
            && self.location.trim().to_lowercase().starts_with(BARRIER)
    }

    /// Whether the sensor may sit on the structure of the vehicle: its location does not begin with an occupant,
    /// another road user or the barrier. An unknown location may.
    pub fn may_be_on_vehicle(&self) -> bool {
        let location = self.location.trim().to_lowercase();
        !ELSEWHERE.iter().any(|word| location.starts_with(word))
    }
}

//! What a sampled signal measures.

use std::fmt;
use std::str::FromStr;

/// A physical quantity known at run time. The samples are always in [`si_unit`](Self::si_unit).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum QuantityKind {
    /// Linear acceleration, m/s².
    Acceleration,
    /// Linear velocity, m/s.
    Velocity,
    /// Change of velocity since the start of the event, m/s (event data recorders).
    VelocityChange,
    /// Displacement, crush or deflection, m.
    Displacement,
    /// Force, N.
    Force,
    /// Moment of force, N·m.
    Moment,
    /// Angle, rad.
    Angle,
    /// Angular velocity, rad/s.
    AngularVelocity,
    /// Angular acceleration, rad/s².
    AngularAcceleration,
    /// Pressure, Pa.
    Pressure,
    /// Voltage, V.
    Voltage,
    /// Anything else; the samples keep the unit of their source, treated as dimensionless.
    Other,
}

impl QuantityKind {
    /// Whether it is a quantity of motion: what the sensors of a vehicle measure beside its pulse.
    pub fn is_motion(self) -> bool {
        use QuantityKind::{
            Acceleration, AngularAcceleration, AngularVelocity, Displacement, Velocity, VelocityChange,
        };
        matches!(self, Acceleration | Velocity | VelocityChange | Displacement | AngularVelocity | AngularAcceleration)
    }

    /// All kinds, in the order of the enumeration.
    pub const ALL: [Self; 12] = [
        Self::Acceleration,
        Self::Velocity,
        Self::VelocityChange,
        Self::Displacement,
        Self::Force,
        Self::Moment,
        Self::Angle,
        Self::AngularVelocity,
        Self::AngularAcceleration,
        Self::Pressure,
        Self::Voltage,
        Self::Other,
    ];

    /// The name used in artifacts, e.g. `velocity_change`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Acceleration => "acceleration",
            Self::Velocity => "velocity",
            Self::VelocityChange => "velocity_change",
            Self::Displacement => "displacement",
            Self::Force => "force",
            Self::Moment => "moment",
            Self::Angle => "angle",
            Self::AngularVelocity => "angular_velocity",
            Self::AngularAcceleration => "angular_acceleration",
            Self::Pressure => "pressure",
            Self::Voltage => "voltage",
            Self::Other => "other",
        }
    }

    /// The SI unit of the samples, e.g. `m/s^2`; `1` for [`Other`](Self::Other).
    pub const fn si_unit(self) -> &'static str {
        match self {
            Self::Acceleration => "m/s^2",
            Self::Velocity | Self::VelocityChange => "m/s",
            Self::Displacement => "m",
            Self::Force => "N",
            Self::Moment => "N*m",
            Self::Angle => "rad",
            Self::AngularVelocity => "rad/s",
            Self::AngularAcceleration => "rad/s^2",
            Self::Pressure => "Pa",
            Self::Voltage => "V",
            Self::Other => "1",
        }
    }
}

impl fmt::Display for QuantityKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for QuantityKind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|kind| kind.name() == text).ok_or_else(|| format!("unknown quantity {text:?}"))
    }
}

/// A quantity known at compile time: the type parameter of [`Signal`](crate::Signal).
pub trait Quantity: Copy + fmt::Debug + Default + Send + Sync + 'static {
    /// The same quantity at run time.
    const KIND: QuantityKind;
}

macro_rules! quantity {
    ($(#[$doc:meta] $name:ident),* $(,)?) => {$(
        #[$doc]
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
        pub struct $name;
        impl Quantity for $name {
            const KIND: QuantityKind = QuantityKind::$name;
        }
    )*};
}

quantity! {
    /// Linear acceleration, m/s².
    Acceleration,
    /// Linear velocity, m/s.
    Velocity,
    /// Displacement, m.
    Displacement,
    /// Force, N.
    Force,
}

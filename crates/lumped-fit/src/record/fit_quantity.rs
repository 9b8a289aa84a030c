//! The quantity that is fitted: displacement, velocity or acceleration of a mass, or the force on the wall.

use std::fmt;
use std::str::FromStr;

use crumple_lumped::{Motion, Waves};
use crumple_signal::QuantityKind;

/// What of a motion is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, PartialOrd, Ord)]
pub enum FitQuantity {
    /// Displacement, m: smooth, and what crush is read from.
    #[default]
    Displacement,
    /// Velocity, m/s.
    Velocity,
    /// Acceleration, m/s²: what the sensor measures; stiff structures show here.
    Acceleration,
    /// Force on the wall, N, positive in compression.
    Force,
}

impl FitQuantity {
    /// Those of a mass.
    pub const ALL: [Self; 3] = [Self::Displacement, Self::Velocity, Self::Acceleration];

    /// The name in options and records.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Force => "force",
        }
    }

    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Displacement => "m",
            Self::Velocity => "m/s",
            Self::Acceleration => "m/s^2",
            Self::Force => "N",
        }
    }

    /// The quantity as a channel has it.
    pub const fn kind(self) -> QuantityKind {
        match self {
            Self::Displacement => QuantityKind::Displacement,
            Self::Velocity => QuantityKind::Velocity,
            Self::Acceleration => QuantityKind::Acceleration,
            Self::Force => QuantityKind::Force,
        }
    }

    /// What is asked of a motion for it.
    pub(crate) const fn waves(self) -> Waves {
        match self {
            Self::Displacement => Waves::Displacement,
            Self::Velocity => Waves::Velocity,
            Self::Acceleration | Self::Force => Waves::Acceleration,
        }
    }

    /// What is recorded before filter and integration: the acceleration, of the wall its force.
    pub(crate) const fn recorded(self) -> Self {
        match self {
            Self::Force => Self::Force,
            _ => Self::Acceleration,
        }
    }

    /// Its samples in a motion, in its unit. The motion of the wall has its force in the place of the acceleration.
    pub(crate) fn of(self, motion: &Motion) -> &[f64] {
        match self {
            Self::Displacement => &motion.displacement_m,
            Self::Velocity => &motion.velocity_m_per_s,
            Self::Acceleration | Self::Force => &motion.acceleration_m_per_s2,
        }
    }
}

impl fmt::Display for FitQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for FitQuantity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|quantity| quantity.name() == text).ok_or_else(|| {
            format!("unknown quantity {text:?}, expected one of {}", Self::ALL.map(Self::name).join(", "))
        })
    }
}

//! The quantity of a motion that is fitted: displacement, velocity or acceleration.

use std::fmt;
use std::str::FromStr;

use crumple_lumped::{Motion, Waves};

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
}

impl FitQuantity {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Displacement, Self::Velocity, Self::Acceleration];

    /// The name in options and records.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
        }
    }

    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Displacement => "m",
            Self::Velocity => "m/s",
            Self::Acceleration => "m/s^2",
        }
    }

    /// What is asked of a motion for it.
    pub(crate) const fn waves(self) -> Waves {
        match self {
            Self::Displacement => Waves::Displacement,
            Self::Velocity => Waves::Velocity,
            Self::Acceleration => Waves::Acceleration,
        }
    }

    /// Its samples in a motion, in its unit.
    pub(crate) fn of(self, motion: &Motion) -> &[f64] {
        match self {
            Self::Displacement => &motion.displacement_m,
            Self::Velocity => &motion.velocity_m_per_s,
            Self::Acceleration => &motion.acceleration_m_per_s2,
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

//! Where every mass is at the start, and how fast.

use crate::LumpedError;
use crate::error::finite;

/// Where every mass is at the start, and how fast. A number is a speed: all masses meet the barrier.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// All masses at zero at this speed, m/s.
    Impact(f64),
    /// Each mass at its own position, with its own velocity: two vehicles, one of them at rest, or a part ahead of the
    /// others.
    Each {
        /// Positions, m.
        positions_m: Vec<f64>,
        /// Velocities, m/s.
        velocities_m_per_s: Vec<f64>,
    },
}

impl From<f64> for Start {
    fn from(impact_speed_m_per_s: f64) -> Self {
        Self::Impact(impact_speed_m_per_s)
    }
}

impl Start {
    /// Each mass at zero with its own velocity, m/s.
    pub fn at_velocities(velocities_m_per_s: Vec<f64>) -> Self {
        Self::Each { positions_m: vec![0.0; velocities_m_per_s.len()], velocities_m_per_s }
    }

    /// Position, m, and velocity, m/s, of a mass.
    pub(crate) fn of_mass(&self, mass: usize) -> [f64; 2] {
        match self {
            Self::Impact(speed) => [0.0, *speed],
            Self::Each { positions_m, velocities_m_per_s } => [positions_m[mass], velocities_m_per_s[mass]],
        }
    }

    /// Kinetic energy of these masses, kg, in J.
    pub(crate) fn kinetic_j(&self, masses_kg: &[f64]) -> f64 {
        match self {
            Self::Impact(speed) => 0.5 * masses_kg.iter().sum::<f64>() * speed.powi(2),
            Self::Each { velocities_m_per_s, .. } => {
                masses_kg.iter().zip(velocities_m_per_s).map(|(mass, v)| 0.5 * mass * v * v).sum()
            }
        }
    }

    /// Refuses what is not finite, and lists of another length than that of the masses.
    pub(crate) fn check(&self, masses: usize) -> Result<(), LumpedError> {
        match self {
            Self::Impact(speed) => finite("impact_speed_m_per_s", *speed),
            Self::Each { positions_m, velocities_m_per_s } => {
                for (name, list) in [("positions at the start", positions_m), ("velocities", velocities_m_per_s)] {
                    if list.len() != masses {
                        let value = list.len() as f64;
                        return Err(LumpedError::Value { name, value, expected: "as many as there are masses" });
                    }
                    list.iter().try_for_each(|value| finite(name, *value))?;
                }
                Ok(())
            }
        }
    }
}

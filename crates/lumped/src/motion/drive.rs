//! What moves a model: an impact, a force, the motion of the barrier.
//!
//! Samples of a drive are linear between each other, as a recorder's are read everywhere in this program; a response to
//! them is exact, and so is that to a half-sine. A drive that is shorter than the response is zero afterwards.

use crate::motion::pulse::{Course, CrashPulse};
use crate::motion::start::Start;

/// A crash is over in so many seconds or never: up to then crush, common velocity and separation are looked for.
pub const HORIZON_S: f64 = 2.0;

/// What moves a model.
#[derive(Debug, Clone, PartialEq)]
pub enum Drive {
    /// All masses meet the barrier at this speed, m/s.
    Impact(f64),
    /// A force on one mass (index from 0) of a model that starts from rest, N, samples at the response's interval,
    /// linear between them and zero after the last.
    Force {
        /// Mass the force acts on.
        mass: usize,
        /// Samples, N, positive towards the barrier.
        samples: Vec<f64>,
    },
    /// The acceleration of the barrier (a sled, a shaker), m/s², in the direction of crush; everything starts from
    /// rest.
    BaseAcceleration(Vec<f64>),
    /// Both: the masses meet the barrier at a speed and a force acts on one of them.
    ImpactAndForce {
        /// Speed, m/s.
        speed_m_per_s: f64,
        /// Mass the force acts on.
        mass: usize,
        /// Samples, N, as above.
        samples: Vec<f64>,
    },
    /// Every mass from its own position at its own velocity.
    Start(Start),
    /// The acceleration of the barrier in the direction of crush, in between samples too; everything starts from rest.
    BasePulse(CrashPulse),
}

impl Drive {
    /// Positions and speeds of all masses at the start.
    pub fn start(&self) -> Start {
        match self {
            Self::Impact(speed) | Self::ImpactAndForce { speed_m_per_s: speed, .. } => Start::Impact(*speed),
            Self::Start(start) => start.clone(),
            Self::Force { .. } | Self::BaseAcceleration(_) | Self::BasePulse(_) => Start::Impact(0.0),
        }
    }

    /// The mass a force acts on, and the force.
    pub(crate) fn force(&self) -> Option<(usize, &[f64])> {
        match self {
            Self::Force { mass, samples } | Self::ImpactAndForce { mass, samples, .. } => Some((*mass, samples)),
            Self::Impact(_) | Self::BaseAcceleration(_) | Self::Start(_) | Self::BasePulse(_) => None,
        }
    }

    /// The acceleration of the barrier.
    pub(crate) fn base(&self) -> Option<&[f64]> {
        match self {
            Self::BaseAcceleration(samples) => Some(samples),
            _ => None,
        }
    }

    /// Samples of the force or of the acceleration; none for an impact.
    pub(crate) fn source(&self) -> &[f64] {
        self.force().map(|(_, samples)| samples).or(self.base()).unwrap_or(&[])
    }

    /// Stretch `number` of the input of samples `dt_s` apart, with the instant of its end, s; `None` after the last.
    pub(crate) fn stretch(&self, number: usize, dt_s: f64) -> Option<(Course, f64)> {
        if let Self::BasePulse(pulse) = self {
            return pulse.stretch(number);
        }
        let source = self.source();
        let value = *source.get(number)?;
        let slope = (source.get(number + 1).copied().unwrap_or(0.0) - value) / dt_s;
        Some((Course::Line { from_s: number as f64 * dt_s, value, slope }, (number + 1) as f64 * dt_s))
    }
}

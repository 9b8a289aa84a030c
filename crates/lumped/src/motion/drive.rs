//! What moves a model: an impact, a force, the motion of the barrier.
//!
//! Samples of a drive are linear between each other, as a recorder's are read everywhere in this program; a response to
//! them is exact. A drive that is shorter than the response is zero afterwards.

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
}

impl Drive {
    /// Speed of all masses at the start, m/s.
    pub fn speed_m_per_s(&self) -> f64 {
        match self {
            Self::Impact(speed) | Self::ImpactAndForce { speed_m_per_s: speed, .. } => *speed,
            Self::Force { .. } | Self::BaseAcceleration(_) => 0.0,
        }
    }

    /// The mass a force acts on, and the force.
    pub(crate) fn force(&self) -> Option<(usize, &[f64])> {
        match self {
            Self::Force { mass, samples } | Self::ImpactAndForce { mass, samples, .. } => Some((*mass, samples)),
            Self::Impact(_) | Self::BaseAcceleration(_) => None,
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
}

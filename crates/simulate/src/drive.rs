//! What moves the models, from records of the test.

use crumple_lumped::{CrashPulse, Drive};
use crumple_signal::Sampled;

// What moves the models: the impact, or a record of the test.

/// What moves the models. Records are on the time axis of the test; what they say before time zero is not used, and
/// after their end a force or an acceleration is 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Excitation<'a> {
    /// The impact speed of the test.
    Impact,
    /// A force on one mass from rest.
    Force {
        /// The force, N, positive towards the barrier.
        record: &'a Sampled,
        /// The mass, from 0 at the barrier.
        mass: usize,
    },
    /// A barrier (sled, shaker) that moves, everything else at rest.
    Base {
        /// Its acceleration, m/s², positive in the direction of crush.
        record: &'a Sampled,
    },
    /// The same by a pulse of a family, from time zero on.
    BasePulse {
        /// The acceleration of the barrier, positive in the direction of crush.
        pulse: &'a CrashPulse,
    },
    /// The impact speed and, as a force on the mass next to the barrier, the whole mass times the measured
    /// acceleration: the forced simulation of the transfer-function paper. Circular: the answer goes in as the
    /// question, and a model that is one rigid mass integrates it to the measured motion.
    PulseAsForce {
        /// The measured acceleration, m/s².
        record: &'a Sampled,
    },
}

impl Excitation<'_> {
    /// Whether models start at the impact speed.
    pub(crate) fn starts_at_impact_speed(&self) -> bool {
        matches!(self, Self::Impact | Self::PulseAsForce { .. })
    }

    /// The drive of a model of `mass_kg` in all at `k dt` after time zero, k = 0 .. `samples`; records are interpolated
    /// linearly, zero outside. Forces are in N, accelerations in m/s². `mass_kg` is used by
    /// [`Excitation::PulseAsForce`] alone, whose force is `mass_kg·a`, negative while the vehicle slows down.
    pub(crate) fn drive(
        &self,
        mass_kg: f64,
        impact_speed_m_per_s: f64,
        time_zero_s: f64,
        dt_s: f64,
        samples: usize,
    ) -> Drive {
        let on_grid = |record: &Sampled, factor: f64| -> Vec<f64> {
            (0..samples).map(|k| factor * record.at(time_zero_s + k as f64 * dt_s).unwrap_or(0.0)).collect()
        };
        match *self {
            Self::Impact => Drive::Impact(impact_speed_m_per_s),
            Self::Force { record, mass } => Drive::Force { mass, samples: on_grid(record, 1.0) },
            Self::Base { record } => Drive::BaseAcceleration(on_grid(record, 1.0)),
            Self::BasePulse { pulse } => Drive::BasePulse(pulse.clone()),
            Self::PulseAsForce { record } => Drive::ImpactAndForce {
                speed_m_per_s: impact_speed_m_per_s,
                mass: 0,
                samples: on_grid(record, mass_kg),
            },
        }
    }
}

//! A made car: its tests, and what each would have measured.

use crumple_estimation::random::RandomNumbers;

use super::channel_class::behind_class;
use super::motion::{Motion, Part, Structure};

/// Sample interval of records and truths, s.
pub(super) const DT_S: f64 = 1e-4;
/// Samples from contact on: 0.2 s, beyond the rebound.
const AFTER: usize = 2001;
/// Steps of the simulator between two samples.
const FINER: usize = 5;
/// Samples before contact in a record, and of rest around a truth while it is filtered: 50 ms.
pub(super) const BEFORE: usize = 500;

/// A car before its test.
#[derive(Debug, Clone)]
pub(super) struct Car {
    pub structure: Structure,
    /// What its test draws from.
    pub random: RandomNumbers,
}

/// What a test without error shows of the compartment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Truth {
    pub crush_m: f64,
    pub time_s: f64,
    /// Largest deceleration behind CFC 60, m/s².
    pub peak_m_per_s2: f64,
    pub restitution: f64,
}

impl Car {
    pub fn mass_kg(&self) -> f64 {
        self.structure.masses_kg.iter().sum()
    }

    /// A test at a speed, m/s, with the car's mass changed by a factor: what is added or taken is in the compartment.
    pub fn test(&self, speed: f64, mass_factor: f64) -> Motion {
        let mut structure = self.structure.clone();
        let more = (mass_factor - 1.0) * self.mass_kg();
        if let Some(compartment) = structure.masses_kg.last_mut() {
            *compartment += more;
        }
        structure.impact(speed, DT_S, AFTER, FINER)
    }

    /// The car as who knows it wholly could know it from tests at these speeds, m/s: each curve up to its deepest crush
    /// in them, from there on its mean without waves.
    pub fn known_from(&self, speeds: impl Iterator<Item = f64>) -> Self {
        let tests: Vec<Motion> = speeds.map(|speed| self.test(speed, 1.0)).collect();
        let mut known = self.clone();
        for (k, joint) in known.structure.joints.iter_mut().enumerate() {
            if let Part::Plastic { known_to_m, .. } = &mut joint.part {
                *known_to_m = tests.iter().map(|test| test.deepest_m[k]).fold(0.0, f64::max);
            }
        }
        known
    }

    /// What such a test shows.
    pub fn truth(&self, speed: f64, mass_factor: f64) -> Truth {
        let motion = self.test(speed, mass_factor);
        let behind_filter = filtered(&motion.acceleration, 60.0);
        Truth {
            crush_m: motion.crush_m,
            time_s: motion.time_s,
            peak_m_per_s2: behind_filter.iter().fold(0.0, |peak, a| peak.max(-a)),
            restitution: motion.restitution,
        }
    }
}

/// An acceleration after contact behind a channel frequency class, 50 ms of rest before it.
pub(super) fn filtered(acceleration: &[f64], class: f64) -> Vec<f64> {
    let mut wave = vec![0.0; BEFORE];
    wave.extend_from_slice(acceleration);
    behind_class(class, &wave, DT_S)
}

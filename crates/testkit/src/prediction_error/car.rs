//! A made car: its tests, and what each would have measured.

use crumple_numerics::estimation::random::RandomNumbers;

use super::motion::{Motion, Structure};
use super::part::Part;
use crate::records::{FINE_S, LowPass};

/// Steps of the simulator from contact on, [`FINE_S`] each: 0.2 s, beyond the rebound.
pub(super) const STEPS: usize = 20_000;
/// Samples of rest before a truth that is filtered: 50 ms.
const REST: usize = 5000;

/// A car before its test.
#[derive(Debug, Clone)]
pub(super) struct Car {
    pub structure: Structure,
    /// What its test draws from.
    pub random: RandomNumbers,
}

/// What a test without error shows of the mass with the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Truth {
    pub crush_m: f64,
    pub time_s: f64,
    /// Largest deceleration behind CFC 60, m/s².
    pub peak_m_per_s2: f64,
    /// Impact speed and rebound together, m/s.
    pub delta_v_m_per_s: f64,
    pub restitution: f64,
}

impl Car {
    pub fn mass_kg(&self) -> f64 {
        self.structure.masses_kg.iter().sum()
    }

    /// A test at a speed, m/s, with the car's mass changed by a factor.
    pub fn test(&self, speed: f64, mass_factor: f64) -> Motion {
        let mut structure = self.structure.clone();
        structure.masses_kg[structure.loaded] += (mass_factor - 1.0) * self.mass_kg();
        structure.impact(speed, FINE_S, STEPS)
    }

    /// The car as who knows it wholly could know it from tests at these speeds, m/s: each curve up to its deepest crush
    /// in them, from there on its mean without waves.
    pub fn known_from(&self, speeds: impl Iterator<Item = f64>) -> Self {
        let tests: Vec<Motion> = speeds.map(|speed| self.test(speed, 1.0)).collect();
        let mut known = self.clone();
        for (k, joint) in known.structure.joints.iter_mut().enumerate() {
            if let Part::Plastic(plastic) = &mut joint.part {
                plastic.known_to_m = tests.iter().map(|test| test.deepest_m[k]).fold(0.0, f64::max);
            }
        }
        known
    }

    /// What such a test shows.
    pub fn truth(&self, speed: f64, mass_factor: f64) -> Truth {
        let motion = self.test(speed, mass_factor);
        let wave = std::iter::repeat_n(0.0, REST).chain(motion.acceleration.iter().copied());
        let behind_filter = LowPass::of_class(60.0).both_ways(wave, FINE_S);
        Truth {
            crush_m: motion.crush_m,
            time_s: motion.time_s,
            peak_m_per_s2: behind_filter.iter().fold(0.0, |peak, a| peak.max(-a)),
            delta_v_m_per_s: speed * (1.0 + motion.restitution),
            restitution: motion.restitution,
        }
    }
}

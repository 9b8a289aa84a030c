//! The kinds of made cars, and how each is drawn.

use crumple_numerics::estimation::random::RandomNumbers;
use crumple_signal::STANDARD_GRAVITY_M_PER_S2;

use super::car::{Car, Truth};
use super::drawing::Drawing;
use super::motion::Structure;

/// A kind of made car.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    /// Name in the tables.
    pub name: &'static str,
    /// Whether its structure stays crushed and depends on the rate by nothing but the strength of steel or foam.
    pub is_plastic: bool,
    draw: Draw,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Draw {
    Buckling,
    EngineGap,
    RateSensitive,
    Bottoming,
    LinearDamped,
    Foam,
    LatePath,
    Power,
    IdealThenStiff,
    LocalMode,
    Pole,
    Electric,
    Viscoelastic,
}

const fn plastic(name: &'static str, draw: Draw) -> Kind {
    Kind { name, is_plastic: true, draw }
}

/// All of them.
pub const KINDS: &[Kind] = &[
    plastic("two masses, buckling", Draw::Buckling),
    plastic("three masses, engine meets the wall", Draw::EngineGap),
    plastic("foam, sled buck", Draw::Foam),
    plastic("rate-sensitive, 2 to 4 % per m/s", Draw::RateSensitive),
    plastic("bottoming out", Draw::Bottoming),
    plastic("late load path", Draw::LatePath),
    plastic("force as x^1.5", Draw::Power),
    plastic("constant force, then stiff", Draw::IdealThenStiff),
    plastic("local mode under the sensor", Draw::LocalMode),
    plastic("pole, tested at 35 km/h", Draw::Pole),
    plastic("electric, battery behind", Draw::Electric),
    Kind { name: "linear, damped", is_plastic: false, draw: Draw::LinearDamped },
    Kind { name: "viscoelastic front", is_plastic: false, draw: Draw::Viscoelastic },
];

/// Speed of the test that is made, km/h, but at the pole.
pub(super) const TESTED_KM_PER_H: f64 = 56.0;
const POLE_KM_PER_H: f64 = 35.0;
/// What a test of a drawn car may show: crush, m, peak behind CFC 60, g, and of plastic kinds restitution.
const CRUSH_M: std::ops::Range<f64> = 0.38..0.95;
const PEAK_G: f64 = 75.0;
const RESTITUTION: std::ops::Range<f64> = 0.06..0.2;

impl Kind {
    /// Speeds of this kind over those of the others.
    pub(super) fn speed_factor(&self) -> f64 {
        if self.draw == Draw::Pole { POLE_KM_PER_H / TESTED_KM_PER_H } else { 1.0 }
    }

    /// The car of a number: what lies outside of the ranges in its test is drawn again.
    pub(super) fn car(&self, number: usize) -> Car {
        let seed = self.name.bytes().fold(0_u64, |seed, byte| seed.wrapping_mul(1_099_511_628_211) ^ u64::from(byte));
        let mut random = RandomNumbers::of_stream(seed, number);
        loop {
            let structure = self.structure(&mut random);
            let car = Car { structure, random: random.clone() };
            if self.has(&car.truth(self.speed_factor() * TESTED_KM_PER_H / 3.6, 1.0)) {
                return car;
            }
        }
    }

    /// Whether such a test is one of this kind.
    fn has(&self, truth: &Truth) -> bool {
        let is_measured = CRUSH_M.contains(&truth.crush_m) && truth.peak_m_per_s2 < PEAK_G * STANDARD_GRAVITY_M_PER_S2;
        is_measured && (self.draw == Draw::LinearDamped || RESTITUTION.contains(&truth.restitution))
    }

    fn structure(&self, random: &mut RandomNumbers) -> Structure {
        let speed = self.speed_factor() * TESTED_KM_PER_H / 3.6;
        let masses_kg = match self.draw {
            Draw::Pole => (873.0, 873.0),
            Draw::Electric => (1700.0, 2700.0),
            Draw::LatePath | Draw::Power | Draw::IdealThenStiff | Draw::LocalMode | Draw::Viscoelastic => {
                (1000.0, 2400.0)
            }
            _ => (900.0, 2200.0),
        };
        let mut drawing = Drawing::new(random, speed, masses_kg);
        match self.draw {
            Draw::LinearDamped => drawing.linear(),
            Draw::Foam => drawing.foam(),
            Draw::Buckling => drawing.buckling(0.0, 0.01, None),
            Draw::RateSensitive => drawing.buckling(0.02, 0.04, None),
            Draw::Bottoming => drawing.buckling(0.0, 0.01, Some((0.85, 1.15))),
            Draw::EngineGap => drawing.engine_gap(),
            Draw::LatePath => drawing.late_path(),
            Draw::Power => drawing.power(),
            Draw::IdealThenStiff => drawing.ideal_then_stiff(),
            Draw::LocalMode => drawing.local_mode(),
            Draw::Pole => drawing.pole(),
            Draw::Electric => drawing.electric(),
            Draw::Viscoelastic => drawing.viscoelastic(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::car::STEPS;
    use super::*;
    use crate::records::FINE_S;

    /// Half the step changes the crush by less than 1e-5, and no energy is lost or made.
    #[test]
    fn drawn_cars_lie_in_their_ranges_and_are_integrated_well() {
        for kind in KINDS {
            for number in [0, 1] {
                let car = kind.car(number);
                let speed = kind.speed_factor() * TESTED_KM_PER_H / 3.6;
                let truth = car.truth(speed, 1.0);
                assert!(kind.has(&truth), "{} {number}: {truth:?}", kind.name);
                let motion = car.test(speed, 1.0);
                let finer = car.structure.impact(speed, 0.5 * FINE_S, 2 * STEPS);
                let change = motion.crush_m / finer.crush_m - 1.0;
                assert!(change.abs() < 1e-5, "{} {number}: {change}", kind.name);
                assert!(motion.energy_error.abs() < 1e-5, "{} {number}: {}", kind.name, motion.energy_error);
            }
        }
    }
}

//! Kinds of made cars, and how each is drawn.

use std::f64::consts::TAU;

use crumple_numerics::estimation::random::RandomNumbers;
use crumple_signal::STANDARD_GRAVITY_M_PER_S2;

use crate::prediction_error::car::{
    Car, CrushCurve, Folding, Joint, Part, Plastic, RateEffect, Structure, Truth, Wave,
};

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
pub(crate) const TESTED_KM_PER_H: f64 = 56.0;
const POLE_KM_PER_H: f64 = 35.0;
/// What a test of a drawn car may show: crush, m, peak behind CFC 60, g, and of plastic kinds restitution.
const CRUSH_M: std::ops::Range<f64> = 0.38..0.95;
const PEAK_G: f64 = 75.0;
const RESTITUTION: std::ops::Range<f64> = 0.06..0.2;

impl Kind {
    /// Speeds of this kind over those of the others.
    pub(crate) fn speed_factor(&self) -> f64 {
        if self.draw == Draw::Pole { POLE_KM_PER_H / TESTED_KM_PER_H } else { 1.0 }
    }

    /// The car of a number: what lies outside of the ranges in its test is drawn again.
    pub(crate) fn car(&self, number: usize) -> Car {
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

/// A car that is being drawn: its size, and the numbers that follow.
pub(crate) struct Drawing<'a> {
    random: &'a mut RandomNumbers,
    speed_m_per_s: f64,
    mass_kg: f64,
    scale_m: f64,
    /// The mean force that stops the car over its scale of crush.
    mean_n: f64,
}

impl<'a> Drawing<'a> {
    /// A mass between these and a scale of crush of 0.45 to 0.75 m, for a test at a speed.
    pub fn new(random: &'a mut RandomNumbers, speed_m_per_s: f64, (lightest, heaviest): (f64, f64)) -> Self {
        let mut drawing = Self { random, speed_m_per_s, mass_kg: 0.0, scale_m: 0.0, mean_n: 0.0 };
        drawing.mass_kg = drawing.between(lightest, heaviest).round();
        drawing.scale_m = drawing.between(0.45, 0.75);
        drawing.mean_n = 0.5 * drawing.mass_kg * speed_m_per_s.powi(2) / drawing.scale_m;
        drawing
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.random.uniform()
    }

    /// A plastic part whose unloading leaves this restitution in the test, and is stiffer than any slope from `from_m`
    /// on.
    fn plastic(&self, curve: CrushCurve, (mass_kg, scale_m): (f64, f64), restitution: f64, from_m: f64) -> Plastic {
        let force = curve.at(scale_m);
        let from_restitution = force * force / (mass_kg * (self.speed_m_per_s * restitution).powi(2));
        Plastic {
            curve,
            unloading_n_per_m: from_restitution.max(1.1 * curve.steepest(from_m, 1.5 * scale_m)),
            unloading_power: 1.0,
            rate: RateEffect::Linear(0.0),
            gap_m: 0.0,
            known_to_m: f64::INFINITY,
            branch: None,
        }
    }

    // The six older kinds: a front that buckles in one wave, straight unloading, a linear rate effect.

    /// Where a structure starts to bottom out and how its force grows there; never, without a place.
    fn one_wave(&mut self, mean_n: f64, scale_m: f64, bottom_m: Option<f64>) -> CrushCurve {
        let start = self.between(0.5, 0.8);
        let mut folding = Folding {
            force_n: mean_n * start,
            rise_n_per_m: mean_n * (1.1 - start) * 2.0 / scale_m,
            bend_m: self.between(0.01, 0.04),
            ..Folding::CONSTANT
        };
        let (height, length_m) = (self.between(0.05, 0.25), self.between(0.08, 0.2));
        folding.waves[0] = Wave { height, length_m, phase: self.between(0.0, TAU) };
        if let Some(bottom_m) = bottom_m {
            folding.bottom_m = bottom_m;
            folding.bottom = (mean_n * self.between(20.0, 60.0) / (scale_m * scale_m), 2);
        }
        CrushCurve::Folding(folding)
    }

    /// A front mass of 15 to 35 % behind a structure that folds, the compartment behind one that is half as strong
    /// again or twice as strong: what stands between engine and occupants is to hold. It bottoms out at a share of the
    /// scale.
    pub fn buckling(&mut self, least_rate: f64, most_rate: f64, bottom: Option<(f64, f64)>) -> Structure {
        let (mass_kg, scale_m, mean_n) = (self.mass_kg, self.scale_m, self.mean_n);
        let bottom_m = bottom.map(|(low, high)| scale_m * self.between(low, high));
        let rate = RateEffect::Linear(self.between(least_rate, most_rate));
        let engine = mass_kg * self.between(0.15, 0.35);
        let restitution = self.between(0.08, 0.2);
        let front = self.one_wave(mean_n, 0.75 * scale_m, bottom_m.map(|b| 0.75 * b));
        let rear_n = mean_n * self.between(1.5, 2.0);
        let rear = self.one_wave(rear_n, 0.3 * scale_m, None);
        let front = self.plastic(front, (mass_kg, scale_m), restitution, 0.0);
        let rear = self.plastic(rear, (mass_kg - engine, 0.4 * scale_m), restitution, 0.0);
        let parts = [front, rear].map(|part| Part::Plastic(Plastic { rate, ..part }));
        Structure::row(&[engine, mass_kg - engine], &parts)
    }

    /// The radiator support in front, rails from it to the compartment, and the engine on its mounts, which reaches the
    /// wall after a gap.
    pub fn engine_gap(&mut self) -> Structure {
        let (mass_kg, scale_m, mean_n) = (self.mass_kg, self.scale_m, self.mean_n);
        let (support, engine) = (mass_kg * self.between(0.03, 0.06), mass_kg * self.between(0.12, 0.2));
        let rate = RateEffect::Linear(self.between(0.0, 0.01));
        let restitution = self.between(0.08, 0.2);
        let mut part = |share: f64, scale: f64, (mass_kg, up_to): (f64, f64)| {
            let curve = self.one_wave(mean_n * share, scale * scale_m, None);
            Plastic { rate, ..self.plastic(curve, (mass_kg, up_to * scale_m), restitution, 0.0) }
        };
        let face = part(0.8, 0.3, (mass_kg, 0.4));
        let rails = part(0.8, 0.8, (mass_kg, 1.0));
        let share = self.between(0.5, 1.0);
        let block = self.one_wave(mean_n * share, 0.2 * scale_m, None);
        let block = Plastic { rate, ..self.plastic(block, (engine, 0.3 * scale_m), restitution, 0.0) };
        let gap_m = scale_m * self.between(0.35, 0.6);
        let share = self.between(0.3, 0.6);
        let firewall = self.one_wave(mean_n * share, 0.3 * scale_m, None);
        let firewall = Plastic { rate, ..self.plastic(firewall, (engine, 0.4 * scale_m), restitution, 0.0) };
        let joint = |front, rear, part| Joint { front, rear, part: Part::Plastic(part) };
        Structure {
            masses_kg: vec![support, engine, mass_kg - support - engine],
            joints: vec![
                joint(None, 0, face),
                joint(Some(0), 2, rails),
                joint(None, 1, Plastic { gap_m, ..block }),
                joint(Some(1), 2, firewall),
            ],
            sensor: 2,
            loaded: 2,
        }
    }

    pub fn foam(&mut self) -> Structure {
        let curve = CrushCurve::Foam {
            plateau_n: self.mean_n * self.between(0.55, 0.8),
            bend_m: self.between(0.01, 0.03),
            thickness_m: self.scale_m * self.between(1.5, 1.9),
        };
        let rate = RateEffect::Linear(self.between(0.0, 0.01));
        let restitution = self.between(0.15, 0.3);
        let part = Plastic { rate, ..self.plastic(curve, (self.mass_kg, self.scale_m), restitution, 0.0) };
        Structure::row(&[self.mass_kg], &[Part::Plastic(part)])
    }

    pub fn linear(&mut self) -> Structure {
        let mass_kg = self.mass_kg;
        let omega = self.speed_m_per_s / self.scale_m * self.between(0.8, 1.1);
        let damped = |mass: f64, omega: f64, zeta: f64| Part::Linear(mass * omega * omega, 2.0 * zeta * mass * omega);
        let front = damped(mass_kg, omega, self.between(0.1, 0.4));
        if self.between(0.0, 1.0) < 0.5 {
            return Structure::row(&[mass_kg], &[front]);
        }
        let engine = mass_kg * 0.25;
        let rear = damped(mass_kg - engine, omega * self.between(1.5, 2.5), self.between(0.1, 0.4));
        Structure::row(&[engine, mass_kg - engine], &[front, rear])
    }

    // The seven newer kinds: folding with an initial peak and a slow random part, straight or concave unloading, three
    // rate effects.

    /// Folding columns of a mean force up to a scale of deflection.
    fn folding(&mut self, mean_n: f64, scale_m: f64) -> Folding {
        let start = self.between(0.6, 1.0);
        let mut wave = |heights: (f64, f64), lengths: (f64, f64)| Wave {
            height: self.between(heights.0, heights.1),
            length_m: self.between(lengths.0, lengths.1),
            phase: self.between(0.0, TAU),
        };
        // Waves of folding, then two slow ones of any phase: the random part.
        let waves = [wave((0.08, 0.3), (0.06, 0.22)), wave((0.0, 0.1), (0.15, 0.4)), wave((0.0, 0.1), (0.3, 0.8))];
        Folding {
            force_n: mean_n * start,
            rise_n_per_m: mean_n * (1.0 - start) * 2.0 / scale_m,
            bend_m: self.between(0.005, 0.02),
            peak: (self.between(0.0, 0.6), self.between(0.02, 0.05)),
            waves,
            ..Folding::CONSTANT
        }
    }

    /// The rate effect of mild steel: in proportion, after Cowper and Symonds in columns 60 to 120 mm wide, or by the
    /// logarithm.
    fn steel(&mut self) -> RateEffect {
        match self.random.below(3) {
            0 => RateEffect::Linear(self.between(0.0, 0.01)),
            1 => RateEffect::CowperSymonds(0.25 / self.between(0.06, 0.12)),
            _ => RateEffect::Logarithmic(self.between(0.005, 0.03)),
        }
    }

    /// A part of steel with this curve at three quarters of the impact's rate; its unloading is straight or concave.
    fn steel_part(&mut self, mut curve: CrushCurve, of: (f64, f64)) -> Plastic {
        let rate = self.steel();
        let scale = 1.0 / rate.factor(0.75 * self.speed_m_per_s);
        match &mut curve {
            CrushCurve::Folding(folding) => {
                folding.force_n *= scale;
                folding.rise_n_per_m *= scale;
                folding.bottom.0 *= scale;
            }
            CrushCurve::Power { force_n, .. } => *force_n *= scale,
            CrushCurve::Foam { plateau_n, .. } => *plateau_n *= scale,
        }
        let restitution = self.between(0.06, 0.2);
        let unloading_power = [1.0, 1.5, 2.0][self.random.below(3)];
        // The first tenth, with the onset and the initial peak, is passed before anything unloads.
        Plastic { rate, unloading_power, ..self.plastic(curve, of, restitution, 0.1 * of.1) }
    }

    /// A front mass of 12 to 35 % behind a curve, the compartment behind a stiffer folding part of so many times the
    /// mean force.
    fn front_and_compartment(&mut self, front: CrushCurve, (low, high): (f64, f64)) -> Structure {
        let (mass_kg, scale_m) = (self.mass_kg, self.scale_m);
        let engine = mass_kg * self.between(0.12, 0.35);
        let rear_n = self.mean_n * self.between(low, high);
        let rear = self.folding(rear_n, 0.3 * scale_m);
        let front = self.steel_part(front, (mass_kg, scale_m));
        let rear = self.steel_part(CrushCurve::Folding(rear), (mass_kg - engine, 0.4 * scale_m));
        let parts = [front, rear].map(Part::Plastic);
        Structure::row(&[engine, mass_kg - engine], &parts)
    }

    /// Folding rails and, beside them, a subframe that meets the wall after 0.3 to 0.75 of the crush: a short peak,
    /// then a plateau of 25 to 60 % of the mean force.
    pub fn late_path(&mut self) -> Structure {
        let (mass_kg, scale_m) = (self.mass_kg, self.scale_m);
        let (gap, plateau) = (self.between(0.3, 0.75), self.between(0.25, 0.6));
        let rails = self.folding(self.mean_n * (1.0 - plateau * (1.0 - gap)), scale_m);
        let subframe = Folding {
            peak: (self.between(0.5, 1.5), self.between(0.01, 0.03)),
            ..self.folding(self.mean_n * plateau, (1.0 - gap) * scale_m)
        };
        let rails = self.steel_part(CrushCurve::Folding(rails), (mass_kg, scale_m));
        let subframe = self.steel_part(CrushCurve::Folding(subframe), (mass_kg, (1.0 - gap) * scale_m));
        let joint = |part| Joint { front: None, rear: 0, part: Part::Plastic(part) };
        let joints = vec![joint(rails), joint(Plastic { gap_m: gap * scale_m, ..subframe })];
        Structure { joints, ..Structure::row(&[mass_kg], &[]) }
    }

    /// A force as the deflection to a power of 1.4 to 1.6, in front of one mass or two.
    pub fn power(&mut self) -> Structure {
        let exponent = self.between(1.4, 1.6);
        let curve = |share: f64| CrushCurve::Power {
            force_n: self.mean_n * (exponent + 1.0),
            length_m: share * self.scale_m,
            exponent,
        };
        let (alone, in_front) = (curve(1.0), curve(0.85));
        if self.random.below(2) == 0 {
            return self.alone(alone);
        }
        self.front_and_compartment(in_front, (1.8, 2.6))
    }

    /// One mass behind a curve of steel.
    fn alone(&mut self, curve: CrushCurve) -> Structure {
        let part = self.steel_part(curve, (self.mass_kg, self.scale_m));
        Structure::row(&[self.mass_kg], &[Part::Plastic(part)])
    }

    /// A constant force up to 0.75 to 1.15 of the crush, then 4 to 12 times the mean stiffness.
    pub fn ideal_then_stiff(&mut self) -> Structure {
        let (knee, stiffness) = (self.between(0.75, 1.15), self.between(4.0, 12.0));
        let (beyond, bend_m) = ((1.0 - knee).max(0.0), self.between(0.005, 0.02));
        self.alone(CrushCurve::Folding(Folding {
            force_n: self.mean_n * (1.0 - 0.5 * stiffness * beyond * beyond),
            bend_m,
            bottom_m: knee * self.scale_m,
            bottom: (stiffness * self.mean_n / self.scale_m, 1),
            ..Folding::CONSTANT
        }))
    }

    /// Two masses that fold, the sensor on 2 % of the mass that swings on the compartment at 60 to 120 Hz.
    pub fn local_mode(&mut self) -> Structure {
        let front = self.folding(self.mean_n, 0.75 * self.scale_m);
        let mut structure = self.front_and_compartment(CrushCurve::Folding(front), (1.5, 2.0));
        let plate = 0.02 * self.mass_kg;
        structure.masses_kg[1] -= plate;
        let part = self.swinging(plate, (60.0, 120.0), (0.02, 0.05));
        structure.masses_kg.push(plate);
        structure.joints.push(Joint { front: Some(1), rear: 2, part });
        Structure { sensor: 2, ..structure }
    }

    /// A spring and damper on which a mass swings at a frequency, Hz, with a damping ratio.
    fn swinging(&mut self, mass_kg: f64, frequency_hz: (f64, f64), damping: (f64, f64)) -> Part {
        let omega = TAU * self.between(frequency_hz.0, frequency_hz.1);
        Part::Linear(mass_kg * omega * omega, 2.0 * self.between(damping.0, damping.1) * mass_kg * omega)
    }

    /// Soft until an engine block at 0.6 to 0.85 of the crush, which takes 30 to 55 % of the energy.
    pub fn pole(&mut self) -> Structure {
        let (block, energy) = (self.between(0.6, 0.85), self.between(0.3, 0.55));
        let soft = self.folding(self.mean_n * (1.0 - energy), self.scale_m);
        let stiffness = 2.0 * energy / (1.0 - block).powi(2);
        self.alone(CrushCurve::Folding(Folding {
            bottom_m: block * self.scale_m,
            bottom: (stiffness * self.mean_n / self.scale_m, 1),
            ..soft
        }))
    }

    /// Front and sensor on the body, 20 to 35 % of the mass as a battery behind it on joints of 15 to 40 Hz.
    pub fn electric(&mut self) -> Structure {
        let battery = self.mass_kg * self.between(0.2, 0.35);
        let front = self.folding(self.mean_n, self.scale_m);
        let front = self.steel_part(CrushCurve::Folding(front), (self.mass_kg, self.scale_m));
        let joints = self.swinging(battery, (15.0, 40.0), (0.03, 0.1));
        let row = Structure::row(&[self.mass_kg - battery, battery], &[Part::Plastic(front), joints]);
        Structure { sensor: 0, loaded: 0, ..row }
    }

    /// A plastic spring beside a Maxwell branch of 25 to 70 % of the stiffness that relaxes in 5 to 40 ms.
    pub fn viscoelastic(&mut self) -> Structure {
        let (mass_kg, scale_m) = (self.mass_kg, self.scale_m);
        let (share, relaxation_s) = (self.between(0.25, 0.7), self.between(0.005, 0.04));
        // Stiffness without relaxation stops the mass within its scale.
        let stiffness = 2.0 * self.mean_n / scale_m;
        let spring =
            CrushCurve::Power { force_n: (1.0 - share) * stiffness * scale_m, length_m: scale_m, exponent: 1.0 };
        let restitution = self.between(0.06, 0.2);
        let unloading_power = [1.0, 1.5, 2.0][self.random.below(3)];
        let spring = self.plastic(spring, (mass_kg, scale_m), restitution, 0.0);
        let branch = Some((share * stiffness, relaxation_s));
        Structure::row(&[mass_kg], &[Part::Plastic(Plastic { unloading_power, branch, ..spring })])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction_error::car::STEPS;
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

//! Cars that no family equals: structures, crush curves, rate effects, their motion.

use std::f64::consts::TAU;

use crumple_numerics::estimation::random::RandomNumbers;

use crate::records::{FINE_S, LowPass};

/// Steps of the simulator from contact on, [`FINE_S`] each: 0.2 s, beyond the rebound.
pub(crate) const STEPS: usize = 20_000;

/// A car before its test.
#[derive(Debug, Clone)]
pub(crate) struct Car {
    pub structure: Structure,
    /// What its test draws from.
    pub random: RandomNumbers,
}

/// What a test without error shows of the mass with the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Truth {
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
        Truth {
            crush_m: motion.crush_m,
            time_s: motion.time_s,
            peak_m_per_s2: LowPass::peak_of_class_60(&motion.acceleration, FINE_S),
            delta_v_m_per_s: speed * (1.0 + motion.restitution),
            restitution: motion.restitution,
        }
    }
}

/// What stands between two masses, or a mass and the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Part {
    /// A structure that stays crushed.
    Plastic(Plastic),
    /// A linear spring, N/m, and damper, N·s/m, in parallel; at the wall it opens at zero force.
    Linear(f64, f64),
}

/// A structure that stays crushed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Plastic {
    /// Its static force.
    pub curve: CrushCurve,
    /// Stiffness of unloading, N/m: it gives back `F²/2k` whatever the power.
    pub unloading_n_per_m: f64,
    /// The force while it unloads is a power of the recovery that is left: 1 is straight, above it is concave.
    pub unloading_power: f64,
    /// Force while it is crushed over the static one.
    pub rate: RateEffect,
    /// Way before it is touched, m.
    pub gap_m: f64,
    /// Deflection up to which its curve is known, m; from there the force goes on without waves. Infinite for the
    /// car itself.
    pub known_to_m: f64,
    /// A Maxwell branch beside it: stiffness, N/m, and relaxation time, s. Both open together at zero force.
    pub branch: Option<(f64, f64)>,
}

/// What a plastic part remembers: its set, where and at which force it turned, and whether it is being crushed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Memory {
    set_m: f64,
    turn_m: f64,
    turn_n: f64,
    crushing: bool,
}

impl Memory {
    /// Untouched: the curve starts at once.
    pub const NEW: Self = Self { set_m: 0.0, turn_m: 0.0, turn_n: 0.0, crushing: true };
}

impl Plastic {
    /// Static force while it is crushed, N, at `d` from its touch on.
    pub fn static_force(&self, d: f64) -> f64 {
        if d <= self.known_to_m { self.curve.at(d) } else { self.curve.smooth().at(d) }
    }

    /// Force on the way back and forth from a turn, N.
    fn elastic(&self, memory: Memory, d: f64) -> f64 {
        let left = ((d - memory.set_m) / (memory.turn_m - memory.set_m)).max(0.0);
        memory.turn_n * if self.unloading_power == 1.0 { left } else { left.powf(self.unloading_power) }
    }

    fn force(&self, memory: Memory, d: f64, w: f64) -> f64 {
        let crushing = self.static_force(d) * self.rate.factor(w);
        if memory.crushing { crushing } else { self.elastic(memory, d).min(crushing) }
    }
}

impl Part {
    /// Way before it is touched, m.
    pub fn gap_m(&self) -> f64 {
        if let Self::Plastic(plastic) = self { plastic.gap_m } else { 0.0 }
    }

    /// Force, N, at deflection `d`, rate `w` and a way `slip` of the damper in its branch, and the rate of that way.
    pub fn force(&self, memory: Memory, d: f64, w: f64, slip: f64) -> (f64, f64) {
        match self {
            Self::Linear(k, c) => (k * d + c * w, 0.0),
            Self::Plastic(plastic) => {
                let d = d - plastic.gap_m;
                let force = plastic.force(memory, d, w);
                plastic.branch.map_or((force, 0.0), |(k, relaxation_s)| {
                    ((force + k * (d - slip)).max(0.0), (d - slip) / relaxation_s)
                })
            }
        }
    }

    /// What it remembers after a step that ended at `d` and `w`.
    pub fn after(&self, memory: Memory, d: f64, w: f64) -> Memory {
        let Self::Plastic(plastic) = self else { return memory };
        let d = d - plastic.gap_m;
        if d <= 0.0 {
            return memory;
        }
        let static_n = plastic.static_force(d);
        if memory.crushing && w < 0.0 {
            // The power takes more way for the same energy.
            let recovery_m = 0.5 * (plastic.unloading_power + 1.0) * static_n / plastic.unloading_n_per_m;
            let set_m = (d - recovery_m).max(memory.set_m);
            return Memory { set_m, turn_m: d, turn_n: static_n, crushing: false };
        }
        let meets = w >= 0.0 && plastic.elastic(memory, d) >= static_n * plastic.rate.factor(w);
        Memory { crushing: memory.crushing || meets, ..memory }
    }
}

/// A static force over deflection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum CrushCurve {
    /// Columns that fold: a mean force with a trend, waves and an initial peak on it, and what stops them.
    Folding(Folding),
    /// A foam: a plateau that hardens without end where the cells close.
    Foam {
        /// Force of the plateau, N.
        plateau_n: f64,
        /// Deflection over which the plateau builds up, m.
        bend_m: f64,
        /// Thickness of the foam, m: `plateau (1 + (d / (thickness - d))²)`, straight on from 90 % of it.
        thickness_m: f64,
    },
    /// This force, N, times a power of the deflection over a length, m.
    Power { force_n: f64, length_m: f64, exponent: f64 },
}

/// A mean force that rises with the deflection, times one and what is on it; where it bottoms out, more beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Folding {
    /// Mean force at the start, N.
    pub force_n: f64,
    /// Rise of the mean force, N/m.
    pub rise_n_per_m: f64,
    /// Deflection over which the force builds up, m.
    pub bend_m: f64,
    /// Initial peak `share (d/length) exp(1 - d/length)` on the mean: share and length, m.
    pub peak: (f64, f64),
    /// Waves on the mean, those of folding and slow ones.
    pub waves: [Wave; 3],
    /// Deflection from which the structure bottoms out, m; infinite for never.
    pub bottom_m: f64,
    /// Force there grows by this times a power of what is beyond, N/m to that power.
    pub bottom: (f64, i32),
}

/// `height sin(2 pi d/length + phase)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wave {
    pub height: f64,
    pub length_m: f64,
    pub phase: f64,
}

impl Wave {
    pub const NONE: Self = Self { height: 0.0, length_m: 1.0, phase: 0.0 };

    fn at(self, d: f64) -> f64 {
        self.height * (TAU * d / self.length_m + self.phase).sin()
    }
}

impl Folding {
    /// A constant force that builds up at once, nothing beyond: to be changed.
    pub const CONSTANT: Self = Self {
        force_n: 1.0,
        rise_n_per_m: 0.0,
        bend_m: 1e-9,
        peak: (0.0, 1.0),
        waves: [Wave::NONE; 3],
        bottom_m: f64::INFINITY,
        bottom: (0.0, 1),
    };

    fn at(&self, d: f64) -> f64 {
        let mean = (self.force_n + self.rise_n_per_m * d) * (1.0 - (-d / self.bend_m).exp());
        let (peak, length_m) = self.peak;
        let waves = self.waves.iter().map(|wave| wave.at(d)).sum::<f64>();
        let beyond = (d - self.bottom_m).max(0.0);
        mean * (1.0 + peak * d / length_m * (1.0 - d / length_m).exp() + waves)
            + self.bottom.0 * beyond.powi(self.bottom.1)
    }
}

impl CrushCurve {
    /// The same without waves: what goes on of it where nobody knows in which phase it folds.
    pub fn smooth(mut self) -> Self {
        if let Self::Folding(folding) = &mut self {
            folding.waves = [Wave::NONE; 3];
        }
        self
    }

    /// Static force, N, at a deflection, m; zero without contact.
    pub fn at(self, d: f64) -> f64 {
        if d <= 0.0 {
            return 0.0;
        }
        match self {
            Self::Folding(folding) => folding.at(d),
            Self::Foam { plateau_n, bend_m, thickness_m } => {
                let closing = |d: f64| 1.0 + (d / (thickness_m - d)).powi(2);
                let limit = 0.9 * thickness_m;
                // Slope of the hardening at 90 %: 2 d t / (t - d)³.
                let hardening =
                    if d < limit { closing(d) } else { closing(limit) + 1800.0 / thickness_m * (d - limit) };
                plateau_n * hardening * (1.0 - (-d / bend_m).exp())
            }
            Self::Power { force_n, length_m, exponent } => force_n * (d / length_m).powf(exponent),
        }
    }

    /// The steepest slope between two deflections, N/m, on a grid of a thousandth of the larger one.
    pub fn steepest(self, from_m: f64, to_m: f64) -> f64 {
        let step = to_m / 1000.0;
        let places = (0..1000).map(|i| f64::from(i) * step).filter(|d| *d >= from_m);
        places.map(|d| (self.at(d + step) - self.at(d)) / step).fold(0.0, f64::max)
    }
}

/// A force over the static one, by the rate of the crush.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum RateEffect {
    /// In proportion to the rate, s/m.
    Linear(f64),
    /// `1 + (e/D)^(1/q)` of mild steel, `D` 6844/s and `q` 3.91 (Cowper & Symonds 1957), at strains that grow by this
    /// much a metre of crush: `e` of columns is `0.25 w / width` (Abramowicz & Jones, Int. J. Impact Eng. 2(2), 1984).
    CowperSymonds(f64),
    /// By this share for each factor of e in the rate over 0.5 m/s.
    Logarithmic(f64),
}

impl RateEffect {
    /// The force at rate `w`, m/s, over the static one.
    pub fn factor(self, w: f64) -> f64 {
        match self {
            Self::Linear(s_per_m) => 1.0 + s_per_m * w.max(0.0),
            Self::CowperSymonds(per_m) => 1.0 + (per_m * w.max(0.0) / 6844.0).powf(1.0 / 3.91),
            Self::Logarithmic(share) => 1.0 + share * (w / 0.5).max(1.0).ln(),
        }
    }
}

/// A part and what it joins: the mass in front (`None`: the wall) and the mass behind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Joint {
    pub front: Option<usize>,
    pub rear: usize,
    pub part: Part,
}

/// Masses, and what joins them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Structure {
    pub masses_kg: Vec<f64>,
    pub joints: Vec<Joint>,
    /// The mass with the sensor.
    pub sensor: usize,
    /// The mass that takes what is added to the car.
    pub loaded: usize,
}

/// The motion of the mass with the sensor after contact, sampled.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Motion {
    /// Its acceleration, m/s², positive away from the wall.
    pub acceleration: Vec<f64>,
    /// Largest displacement, m.
    pub crush_m: f64,
    /// Its time, s.
    pub time_s: f64,
    /// Largest speed of the rebound over the speed of the impact.
    pub restitution: f64,
    /// Largest deflection of each joint, from the touch of its part on, m.
    pub deepest_m: Vec<f64>,
    /// What is missing of the energy at the end, over that at contact.
    pub energy_error: f64,
}

impl Structure {
    /// The masses in a row from the wall on, each behind its part; the last carries the sensor and takes what is added.
    pub fn row(masses_kg: &[f64], parts: &[Part]) -> Self {
        let joint = |(rear, part): (usize, &Part)| Joint { front: rear.checked_sub(1), rear, part: *part };
        let last = masses_kg.len() - 1;
        let joints = parts.iter().enumerate().map(joint).collect();
        Self { masses_kg: masses_kg.to_vec(), joints, sensor: last, loaded: last }
    }

    /// Deflection and its rate of a joint.
    fn deflection(&self, joint: &Joint, state: &[f64]) -> (f64, f64) {
        let n = self.masses_kg.len();
        let (front, speed) = joint.front.map_or((0.0, 0.0), |i| (state[i], state[n + i]));
        (state[joint.rear] - front, state[n + joint.rear] - speed)
    }

    /// Rates of a state: displacements and velocities of the masses, ways of the dampers in branches, work of all
    /// joints.
    fn rates(&self, memory: &[Memory], state: &[f64], rates: &mut [f64]) {
        let n = self.masses_kg.len();
        rates.fill(0.0);
        rates[..n].copy_from_slice(&state[n..2 * n]);
        let mut power = 0.0;
        for (k, (joint, memory)) in self.joints.iter().zip(memory).enumerate() {
            let (d, w) = self.deflection(joint, state);
            let (mut force, slip) = joint.part.force(*memory, d, w, state[2 * n + k]);
            rates[2 * n + k] = slip;
            match joint.front {
                Some(front) => rates[n + front] += force / self.masses_kg[front],
                None => force = force.max(0.0),
            }
            rates[n + joint.rear] -= force / self.masses_kg[joint.rear];
            power += force * w;
        }
        if let Some(work) = rates.last_mut() {
            *work = power;
        }
    }

    fn kinetic_j(&self, velocities: &[f64]) -> f64 {
        self.masses_kg.iter().zip(velocities).map(|(m, v)| 0.5 * m * v * v).sum()
    }

    /// The motion after an impact at `speed`, m/s, in steps of `h`, s, by Runge and Kutta's fourth order; branches
    /// change at the ends of steps. Samples are the starts of the steps.
    pub fn impact(&self, speed: f64, h: f64, steps: usize) -> Motion {
        let n = self.masses_kg.len();
        let mut state = vec![0.0; 2 * n + self.joints.len() + 1];
        state[n..2 * n].fill(speed);
        let mut memory = vec![Memory::NEW; self.joints.len()];
        let mut motion = Motion {
            acceleration: Vec::with_capacity(steps),
            crush_m: 0.0,
            time_s: 0.0,
            restitution: 0.0,
            deepest_m: vec![0.0; self.joints.len()],
            energy_error: 0.0,
        };
        let mut rates = [(); 4].map(|()| vec![0.0; state.len()]);
        let mut middle = state.clone();
        for step in 1..=steps {
            for (stage, share) in [0.0, 0.5, 0.5, 1.0].into_iter().enumerate() {
                middle.copy_from_slice(&state);
                if stage > 0 {
                    middle.iter_mut().zip(&rates[stage - 1]).for_each(|(y, rate)| *y += share * h * rate);
                }
                self.rates(&memory, &middle, &mut rates[stage]);
            }
            motion.acceleration.push(rates[0][n + self.sensor]);
            for (i, y) in state.iter_mut().enumerate() {
                *y += h / 6.0 * (rates[0][i] + 2.0 * (rates[1][i] + rates[2][i]) + rates[3][i]);
            }
            if state[self.sensor] > motion.crush_m {
                motion.crush_m = state[self.sensor];
                motion.time_s = step as f64 * h;
            }
            motion.restitution = motion.restitution.max(-state[n + self.sensor] / speed);
            for ((joint, memory), deepest_m) in self.joints.iter().zip(&mut memory).zip(&mut motion.deepest_m) {
                let (d, w) = self.deflection(joint, &state);
                *deepest_m = deepest_m.max(d - joint.part.gap_m());
                *memory = joint.part.after(*memory, d, w);
            }
        }
        let before = self.kinetic_j(&vec![speed; n]);
        motion.energy_error = (self.kinetic_j(&state[n..2 * n]) + state[state.len() - 1]) / before - 1.0;
        motion
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MASS_KG: f64 = 1500.0;

    fn one(part: Part) -> Structure {
        Structure::row(&[MASS_KG], &[part])
    }

    fn folding() -> Plastic {
        let wave = Wave { height: 0.2, length_m: 0.12, phase: 0.7 };
        let folding = Folding {
            force_n: 1.5e5,
            rise_n_per_m: 3e5,
            bend_m: 0.03,
            waves: [wave, Wave::NONE, Wave::NONE],
            ..Folding::CONSTANT
        };
        plastic(CrushCurve::Folding(folding))
    }

    fn plastic(curve: CrushCurve) -> Plastic {
        Plastic {
            curve,
            unloading_n_per_m: 2.5e7,
            unloading_power: 1.0,
            rate: RateEffect::Linear(0.0),
            gap_m: 0.0,
            known_to_m: f64::INFINITY,
            branch: None,
        }
    }

    /// A linear spring: crush `v0/omega` at a quarter of the period; the step of 1e-5 s leaves its own size in the
    /// time.
    #[test]
    fn a_linear_spring_swings_as_it_must() {
        let (k, v0) = (1.2e6, 15.0);
        let omega = (k / MASS_KG).sqrt();
        let motion = one(Part::Linear(k, 0.0)).impact(v0, 1e-5, 15_000);
        assert!((motion.crush_m - v0 / omega).abs() < 1e-6, "{}", motion.crush_m);
        assert!((motion.time_s - 0.5 * std::f64::consts::PI / omega).abs() < 1e-5, "{}", motion.time_s);
        assert!((motion.restitution - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_curve_goes_on_without_waves_from_where_it_is_known() {
        let curve = Folding {
            force_n: 1e5,
            rise_n_per_m: 2e5,
            bend_m: 0.02,
            waves: [Wave { height: 0.2, length_m: 0.1, phase: 0.0 }, Wave::NONE, Wave::NONE],
            bottom_m: 0.4,
            bottom: (1e6, 2),
            ..Folding::CONSTANT
        };
        let part = |known_to_m| Plastic {
            unloading_n_per_m: 1e8,
            gap_m: 0.1,
            known_to_m,
            ..plastic(CrushCurve::Folding(curve))
        };
        assert_eq!(part(0.3).static_force(0.3), part(1.0).static_force(0.3));
        // 0.525 m are a quarter of a wave.
        let (known, smooth) = (part(1.0).static_force(0.525), part(0.3).static_force(0.525));
        assert!((smooth - (1e5 + 2e5 * 0.525) - 1e6 * 0.125_f64.powi(2)).abs() < 1e-4, "{smooth}");
        assert!((known - smooth - 0.2 * (1e5 + 2e5 * 0.525)).abs() < 1e-4, "{known}");
        let motion = |known_to_m| one(Part::Plastic(part(known_to_m))).impact(8.0, 2e-5, 10_000);
        let whole = motion(f64::INFINITY);
        // The last step reaches beyond the deepest crush between its ends.
        assert!((whole.crush_m - motion(whole.deepest_m[0]).crush_m).abs() < 1e-6);
        assert!((whole.deepest_m[0] + 0.1 - whole.crush_m).abs() < 1e-12);
        assert_ne!(motion(0.5 * whole.deepest_m[0]).crush_m, whole.crush_m);
    }

    /// Work of the curve up to the crush is the kinetic energy; what comes back is `F²/2k_u`, whatever the power of the
    /// unloading.
    #[test]
    fn a_plastic_part_takes_the_energy_and_gives_back_what_the_unloading_holds() {
        for unloading_power in [1.0, 1.5, 2.0] {
            let part = Plastic { unloading_power, ..folding() };
            let motion = one(Part::Plastic(part)).impact(15.0, 1e-5, 20_000);
            let step = motion.crush_m / 1e5;
            let work: f64 = (0..100_000).map(|i| part.static_force((i as f64 + 0.5) * step) * step).sum();
            let kinetic = 0.5 * MASS_KG * 15.0 * 15.0;
            // The turn is seen at the end of a step of 1e-5 s.
            assert!((work / kinetic - 1.0).abs() < 1e-5, "{work} {kinetic}");
            let e = part.static_force(motion.crush_m) / (15.0 * (MASS_KG * part.unloading_n_per_m).sqrt());
            assert!((motion.restitution / e - 1.0).abs() < 1e-3, "{} {e}", motion.restitution);
            assert!(motion.energy_error.abs() < 1e-6, "{}", motion.energy_error);
        }
    }

    /// A constant force with a rate effect: `m v dv = -F factor(v) dx`, so the crush is `m/F` times the integral of
    /// `v/factor(v)`, here by the midpoint rule. A linear effect has a closed form too.
    #[test]
    fn rate_effects_stop_a_mass_where_their_integral_says() {
        let (force_n, v0) = (2.5e5, 15.0);
        let curve = CrushCurve::Folding(Folding { force_n, ..Folding::CONSTANT });
        let effects = [RateEffect::Linear(0.03), RateEffect::CowperSymonds(2.5), RateEffect::Logarithmic(0.05)];
        for rate in effects {
            let motion = one(Part::Plastic(Plastic { rate, ..plastic(curve) })).impact(v0, 1e-5, 15_000);
            let dv = v0 / 1e5;
            let crush_m: f64 = (0..100_000).map(|i| (i as f64 + 0.5) * dv).map(|v| v / rate.factor(v) * dv).sum();
            let crush_m = MASS_KG / force_n * crush_m;
            // The first of the four stages of the first step meets no force yet: its sixth of 3e-3 m/s is 4e-5 of v0².
            assert!((motion.crush_m / crush_m - 1.0).abs() < 1e-4, "{rate:?} {} {crush_m}", motion.crush_m);
            if let RateEffect::Linear(r) = rate {
                let closed_m = MASS_KG / force_n * (v0 / r - (r * v0).ln_1p() / (r * r));
                assert!((crush_m / closed_m - 1.0).abs() < 1e-8, "{crush_m} {closed_m}");
            }
        }
    }

    /// A Maxwell branch alone is a damped oscillator of its force: `f'' + f'/tau + omega² f = 0`, so with
    /// `s = 1/(2 tau)` and `p² = omega² - s²` the velocity is `v0 exp(-s t) (cos(p t) + s/p sin(p t))`, which is zero
    /// at `tan(p t) = -p/s`; the crush is the integral up to there.
    #[test]
    fn a_branch_relaxes_as_its_closed_form() {
        let (k, relaxation_s, v0) = (1.2e6, 0.04, 15.0);
        let part = Plastic {
            branch: Some((k, relaxation_s)),
            ..plastic(CrushCurve::Power { force_n: 0.0, length_m: 1.0, exponent: 1.0 })
        };
        let motion = one(Part::Plastic(part)).impact(v0, 1e-5, 20_000);
        let s = 0.5 / relaxation_s;
        let p = (k / MASS_KG - s * s).sqrt();
        let stop_s = (std::f64::consts::PI - (p / s).atan()) / p;
        let velocity = |t: f64| v0 * (-s * t).exp() * ((p * t).cos() + s / p * (p * t).sin());
        let step = stop_s / 1e5;
        let crush_m: f64 = (0..100_000).map(|i| velocity((i as f64 + 0.5) * step) * step).sum();
        assert!((motion.crush_m / crush_m - 1.0).abs() < 1e-6, "{} {crush_m}", motion.crush_m);
        assert!((motion.time_s - stop_s).abs() < 1.1e-5, "{} {stop_s}", motion.time_s);
    }
}

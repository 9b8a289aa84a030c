//! Motions of made cars by small fixed steps: a simulator of its own, that shares nothing with the product's.

use super::part::{Memory, Part};

/// A part and what it joins: the mass in front (`None`: the wall) and the mass behind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Joint {
    pub front: Option<usize>,
    pub rear: usize,
    pub part: Part,
}

/// Masses, and what joins them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Structure {
    pub masses_kg: Vec<f64>,
    pub joints: Vec<Joint>,
    /// The mass with the sensor.
    pub sensor: usize,
    /// The mass that takes what is added to the car.
    pub loaded: usize,
}

/// The motion of the mass with the sensor after contact, sampled.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Motion {
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
    use super::super::crush_curve::{CrushCurve, Folding, Wave};
    use super::super::part::Plastic;
    use super::super::rate_effect::RateEffect;
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

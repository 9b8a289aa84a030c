//! Motions of made cars by small fixed steps: a simulator of its own, that shares nothing with the product's.

use super::crush_curve::CrushCurve;

/// What stands between two masses, or a mass and the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Part {
    /// A structure that stays crushed.
    Plastic {
        /// Its static force.
        curve: CrushCurve,
        /// Stiffness of unloading, N/m.
        unloading_n_per_m: f64,
        /// The force while it is crushed is the static one times `1 + rate w`, s/m.
        rate_s_per_m: f64,
        /// Way before it is touched, m.
        gap_m: f64,
        /// Deflection up to which its curve is known, m; from there the force goes on without waves. Infinite for the
        /// car itself.
        known_to_m: f64,
    },
    /// A linear spring, N/m, and damper, N·s/m, in parallel.
    Linear(f64, f64),
}

/// A part and what it joins: the mass in front (`None`: the wall) and the mass behind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Joint {
    pub front: Option<usize>,
    pub rear: usize,
    pub part: Part,
}

/// Masses from the wall to the compartment, and what joins them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Structure {
    pub masses_kg: Vec<f64>,
    pub joints: Vec<Joint>,
}

/// The compartment's motion after contact, sampled.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Motion {
    /// Acceleration of the compartment, m/s², positive away from the wall.
    pub acceleration: Vec<f64>,
    /// Largest displacement, m.
    pub crush_m: f64,
    /// Its time, s.
    pub time_s: f64,
    /// Largest speed of the rebound over the speed of the impact.
    pub restitution: f64,
    /// Largest deflection of each joint, from the touch of its part on, m.
    pub deepest_m: Vec<f64>,
}

/// What a plastic part remembers: its set, and whether it is being crushed.
#[derive(Debug, Clone, Copy, Default)]
struct Memory {
    set_m: f64,
    crushing: bool,
}

impl Part {
    /// Way before it is touched, m.
    fn gap_m(&self) -> f64 {
        match *self {
            Self::Linear(..) => 0.0,
            Self::Plastic { gap_m, .. } => gap_m,
        }
    }

    /// Static force of a plastic part while it is crushed, N, at `d` from its touch on.
    fn static_force(curve: CrushCurve, known_to_m: f64, d: f64) -> f64 {
        if d <= known_to_m { curve.at(d) } else { curve.smooth().at(d) }
    }

    /// Force, N, at deflection `d` and rate `w`.
    fn force(&self, memory: Memory, d: f64, w: f64) -> f64 {
        match *self {
            Self::Linear(k, c) => k * d + c * w,
            Self::Plastic { curve, unloading_n_per_m, rate_s_per_m, gap_m, known_to_m } => {
                let d = d - gap_m;
                let crushing = Self::static_force(curve, known_to_m, d) * (1.0 + rate_s_per_m * w.max(0.0));
                let elastic = (unloading_n_per_m * (d - memory.set_m)).max(0.0);
                if memory.crushing || elastic > crushing { crushing } else { elastic }
            }
        }
    }

    /// What it remembers after a step that ended at `d` and `w`.
    fn after(&self, memory: Memory, d: f64, w: f64) -> Memory {
        let Self::Plastic { curve, unloading_n_per_m, rate_s_per_m, gap_m, known_to_m } = *self else {
            return memory;
        };
        let d = d - gap_m;
        let static_n = Self::static_force(curve, known_to_m, d);
        if memory.crushing && w < 0.0 {
            return Memory { set_m: (d - static_n / unloading_n_per_m).max(memory.set_m), crushing: false };
        }
        let meets = unloading_n_per_m * (d - memory.set_m) >= static_n * (1.0 + rate_s_per_m * w.max(0.0));
        Memory { crushing: memory.crushing || (w >= 0.0 && d > 0.0 && meets), ..memory }
    }
}

impl Structure {
    /// Deflection and its rate of a joint.
    fn deflection(&self, joint: &Joint, x: &[f64], v: &[f64]) -> (f64, f64) {
        let (front, speed) = joint.front.map_or((0.0, 0.0), |i| (x[i], v[i]));
        (x[joint.rear] - front, v[joint.rear] - speed)
    }

    fn accelerations(&self, memory: &[Memory], x: &[f64], v: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; self.masses_kg.len()];
        for (joint, memory) in self.joints.iter().zip(memory) {
            let (d, w) = self.deflection(joint, x, v);
            let f = joint.part.force(*memory, d, w);
            force[joint.rear] -= f;
            if let Some(front) = joint.front {
                force[front] += f;
            }
        }
        force.iter().zip(&self.masses_kg).map(|(f, m)| f / m).collect()
    }

    /// The motion after an impact at `speed`, m/s, `samples` samples `dt_s` apart, `finer` steps of Runge and Kutta's
    /// fourth order between two samples; branches change at the ends of steps.
    pub fn impact(&self, speed: f64, dt_s: f64, samples: usize, finer: usize) -> Motion {
        let n = self.masses_kg.len();
        let h = dt_s / finer as f64;
        let (mut x, mut v) = (vec![0.0; n], vec![speed; n]);
        let mut memory = vec![Memory { set_m: 0.0, crushing: true }; self.joints.len()];
        let mut motion = Motion {
            acceleration: Vec::with_capacity(samples),
            crush_m: 0.0,
            time_s: 0.0,
            restitution: 0.0,
            deepest_m: vec![0.0; self.joints.len()],
        };
        let shifted =
            |a: &[f64], by: f64, b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a + by * b).collect() };
        for k in 0..samples {
            motion.acceleration.push(self.accelerations(&memory, &x, &v)[n - 1]);
            for step in 0..finer {
                let a1 = self.accelerations(&memory, &x, &v);
                let (x2, v2) = (shifted(&x, 0.5 * h, &v), shifted(&v, 0.5 * h, &a1));
                let a2 = self.accelerations(&memory, &x2, &v2);
                let (x3, v3) = (shifted(&x, 0.5 * h, &v2), shifted(&v, 0.5 * h, &a2));
                let a3 = self.accelerations(&memory, &x3, &v3);
                let (x4, v4) = (shifted(&x, h, &v3), shifted(&v, h, &a3));
                let a4 = self.accelerations(&memory, &x4, &v4);
                for i in 0..n {
                    x[i] += h / 6.0 * (v[i] + 2.0 * (v2[i] + v3[i]) + v4[i]);
                    v[i] += h / 6.0 * (a1[i] + 2.0 * (a2[i] + a3[i]) + a4[i]);
                }
                if x[n - 1] > motion.crush_m {
                    motion.crush_m = x[n - 1];
                    motion.time_s = k as f64 * dt_s + (step + 1) as f64 * h;
                }
                motion.restitution = motion.restitution.max(-v[n - 1] / speed);
                for ((joint, memory), deepest_m) in self.joints.iter().zip(&mut memory).zip(&mut motion.deepest_m) {
                    let (d, w) = self.deflection(joint, &x, &v);
                    *deepest_m = deepest_m.max(d - joint.part.gap_m());
                    *memory = joint.part.after(*memory, d, w);
                }
            }
        }
        motion
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(part: Part) -> Structure {
        Structure { masses_kg: vec![1500.0], joints: vec![Joint { front: None, rear: 0, part }] }
    }

    /// A linear spring: crush `v0/omega` at a quarter of the period; the step of 1e-5 s leaves its own size in the
    /// time.
    #[test]
    fn a_linear_spring_swings_as_it_must() {
        let (k, v0) = (1.2e6, 15.0);
        let omega = (k / 1500.0_f64).sqrt();
        let motion = one(Part::Linear(k, 0.0)).impact(v0, 1e-4, 1500, 10);
        assert!((motion.crush_m - v0 / omega).abs() < 1e-6, "{}", motion.crush_m);
        assert!((motion.time_s - 0.5 * std::f64::consts::PI / omega).abs() < 1e-5, "{}", motion.time_s);
        assert!((motion.restitution - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_curve_goes_on_without_waves_from_where_it_is_known() {
        let curve = CrushCurve::Buckling {
            force_n: 1e5,
            rise_n_per_m: 2e5,
            bend_m: 0.02,
            wave: 0.2,
            length_m: 0.1,
            phase: 0.0,
            bottom_m: 0.4,
            bottom_n_per_m2: 1e6,
        };
        let part =
            |known_to_m| Part::Plastic { curve, unloading_n_per_m: 1e8, rate_s_per_m: 0.0, gap_m: 0.1, known_to_m };
        assert_eq!(Part::static_force(curve, 0.3, 0.3), curve.at(0.3));
        // 0.525 m are a quarter of a wave.
        let (known, smooth) = (curve.at(0.525), Part::static_force(curve, 0.3, 0.525));
        assert!((smooth - (1e5 + 2e5 * 0.525) - 1e6 * 0.125_f64.powi(2)).abs() < 1e-4, "{smooth}");
        assert!((known - smooth - 0.2 * (1e5 + 2e5 * 0.525)).abs() < 1e-4, "{known}");
        let whole = one(part(f64::INFINITY)).impact(8.0, 1e-4, 2000, 5);
        let known = one(part(whole.deepest_m[0])).impact(8.0, 1e-4, 2000, 5);
        // The last step reaches beyond the deepest crush between its ends.
        assert!((whole.crush_m - known.crush_m).abs() < 1e-6);
        assert!((whole.deepest_m[0] + 0.1 - whole.crush_m).abs() < 1e-12);
        assert_ne!(one(part(0.5 * whole.deepest_m[0])).impact(8.0, 1e-4, 2000, 5).crush_m, whole.crush_m);
    }

    /// Work of the curve up to the crush is the kinetic energy; what comes back is `F²/2k_u`.
    #[test]
    fn a_plastic_part_takes_the_energy_and_gives_back_what_the_unloading_holds() {
        let curve = CrushCurve::Buckling {
            force_n: 1.5e5,
            rise_n_per_m: 3e5,
            bend_m: 0.03,
            wave: 0.2,
            length_m: 0.12,
            phase: 0.7,
            bottom_m: f64::INFINITY,
            bottom_n_per_m2: 0.0,
        };
        let ku = 2.5e7;
        let part =
            Part::Plastic { curve, unloading_n_per_m: ku, rate_s_per_m: 0.0, gap_m: 0.0, known_to_m: f64::INFINITY };
        let motion = one(part).impact(15.0, 1e-4, 2000, 10);
        let step = motion.crush_m / 1e5;
        let work: f64 = (0..100_000).map(|i| curve.at((i as f64 + 0.5) * step) * step).sum();
        let kinetic = 0.5 * 1500.0 * 15.0 * 15.0;
        // The turn is seen at the end of a step of 1e-5 s.
        assert!((work / kinetic - 1.0).abs() < 1e-5, "{work} {kinetic}");
        let e = curve.at(motion.crush_m) / (15.0 * (1500.0 * ku).sqrt());
        assert!((motion.restitution / e - 1.0).abs() < 1e-3, "{} {e}", motion.restitution);
    }
}

//! Derivatives of the nonlinear motions: the variational equation along the Taylor series of the motion.

use crate::curve::{Curve, Knot};
use crate::secant_motion::SecantMotion;
use crate::secant_step::{LANES, Law, ORDER, Step};
use crate::{Instants, LumpedError, Motion, Sensitivity, State};

/// A small change of the motion, at the start of a step.
#[derive(Debug, Clone, Copy, Default)]
struct Change {
    x: f64,
    v: f64,
}

/// The change over a step, as series.
struct Series {
    x: [f64; ORDER + 1],
    v: [f64; ORDER + 1],
    /// What the parameter changes in the law.
    law: Law,
}

impl Series {
    /// Displacement, velocity and acceleration of the change at several times after the step's start, where the motion itself
    /// has `states`.
    fn waves(
        &self,
        step: &Step,
        tau: [f64; LANES],
        states: &([f64; LANES], [f64; LANES], [f64; LANES]),
    ) -> [State; LANES] {
        let (mut x, mut v) = ([0.0; LANES], [0.0; LANES]);
        for (of_x, of_v) in self.x.iter().zip(&self.v).rev() {
            for lane in 0..LANES {
                x[lane] = x[lane] * tau[lane] + of_x;
                v[lane] = v[lane] * tau[lane] + of_v;
            }
        }
        let law = &step.law;
        std::array::from_fn(|lane| {
            let (x, v, sx, sv) = (x[lane], v[lane], states.0[lane], states.1[lane]);
            let own = (law.k0 + 2.0 * law.k1 * sx) * x + (law.c0 + 2.0 * law.c1 * sv) * v;
            State { displacement_m: x, velocity_m_per_s: v, acceleration_m_per_s2: self.law.acceleration(sx, sv) - own }
        })
    }

    /// Displacement and velocity of the change at the end of the step.
    fn end(&self, step: &Step) -> Change {
        let at = |series: &[f64; ORDER + 1]| series.iter().rev().fold(0.0, |sum, term| sum * step.length_s + term);
        Change { x: at(&self.x), v: at(&self.v) }
    }
}

/// Products of the step's series with themselves.
struct Products {
    xx: [f64; ORDER + 1],
    vv: [f64; ORDER + 1],
}

fn convolve(a: &[f64; ORDER + 1], b: &[f64; ORDER + 1], k: usize) -> f64 {
    (0..=k).map(|i| a[i] * b[k - i]).sum()
}

impl Products {
    fn of(step: &Step) -> Self {
        Self {
            xx: std::array::from_fn(|k| convolve(&step.x, &step.x, k)),
            vv: std::array::from_fn(|k| convolve(&step.v, &step.v, k)),
        }
    }

    /// `y'' = -(k0 + 2 k1 x) y - (c0 + 2 c1 v) y' - (change of the law)`.
    fn series(&self, step: &Step, start: Change, law: Law) -> Series {
        let mut found = Series { x: [0.0; ORDER + 1], v: [0.0; ORDER + 1], law };
        (found.x[0], found.v[0]) = (start.x, start.v);
        let now = &step.law;
        for k in 0..ORDER {
            let own = now.k0 * found.x[k]
                + 2.0 * now.k1 * convolve(&step.x, &found.x, k)
                + now.c0 * found.v[k]
                + 2.0 * now.c1 * convolve(&step.v, &found.v, k);
            let forced = law.k0 * step.x[k] + law.k1 * self.xx[k] + law.c0 * step.v[k] + law.c1 * self.vv[k];
            let by = 1.0 / (k + 1) as f64;
            found.x[k + 1] = found.v[k] * by;
            found.v[k + 1] = -(own + forced) * by;
        }
        found
    }
}

impl SecantMotion {
    /// What a parameter changes in the law of a step. Places: mass, values of the spring, its inner knots, values of
    /// the damper, its inner knots, last knot of the spring, last knot of the damper.
    fn change_of_law(&self, step: &Step, place: usize) -> Law {
        let (springs, dampers) = (self.spring.len(), self.damper.len());
        let by = 1.0 / self.mass_kg;
        let knot = match place {
            0 => {
                let law = &step.law;
                return Law { k0: -by * law.k0, k1: -by * law.k1, c0: -by * law.c0, c1: -by * law.c1 };
            }
            p if p <= springs => (true, Knot::Value(p - 1)),
            p if p < 2 * springs - 1 => (true, Knot::Place(p - springs)),
            p => match p - (2 * springs - 1) {
                d if d < dampers => (false, Knot::Value(d)),
                d if d < 2 * dampers - 2 => (false, Knot::Place(d - dampers + 1)),
                d if d == 2 * dampers - 2 => (true, Knot::Place(springs - 1)),
                _ => (false, Knot::Place(dampers - 1)),
            },
        };
        let none = Law { k0: 0.0, k1: 0.0, c0: 0.0, c1: 0.0 };
        let change = |curve: &Curve, piece: usize, knot: Knot| curve.change_of_piece(piece, knot);
        match knot {
            (true, knot) => {
                let (constant, slope) = change(&self.spring, step.spring_piece, knot);
                Law { k0: by * constant, k1: by * slope * step.sign_x, ..none }
            }
            (false, knot) => {
                let (constant, slope) = change(&self.damper, step.damper_piece, knot);
                Law { c0: by * constant, c1: by * slope * step.sign_v, ..none }
            }
        }
    }

    /// Motion and derivatives at the instants; places as in the parameter names of the nonlinear models.
    pub fn sensitivity(
        &self,
        impact_speed_m_per_s: f64,
        at: &Instants,
        parameters: &[usize],
    ) -> Result<Sensitivity, LumpedError> {
        let mut motion = Motion::with_capacity(at.samples);
        let mut derivatives = vec![vec![Motion::with_capacity(at.samples)]; parameters.len()];
        let mut changes = vec![Change::default(); parameters.len()];
        let mut next = 0;
        let end_s = at.first_s + at.dt_s * at.samples as f64;
        let time = |k: usize| at.first_s + k as f64 * at.dt_s;
        // Series of the parameters' changes over a step, and blocks of its instants; kept to be filled again.
        let mut series = Vec::with_capacity(parameters.len());
        self.walk(impact_speed_m_per_s, end_s, |step| {
            let stop = step.start_s + step.length_s;
            let first = next;
            while next < at.samples && time(next) <= stop {
                next += 1;
            }
            series.clear();
            if !parameters.is_empty() {
                let products = Products::of(step);
                let law = |place| self.change_of_law(step, place);
                series
                    .extend(parameters.iter().zip(&changes).map(|(p, change)| products.series(step, *change, law(*p))));
            }
            for block in (first..next).step_by(LANES) {
                let tau = std::array::from_fn(|lane| time(block + lane) - step.start_s);
                let states = step.waves(tau);
                // Lanes beyond the step are not used.
                let lanes = LANES.min(next - block);
                motion.displacement_m.extend_from_slice(&states.0[..lanes]);
                motion.velocity_m_per_s.extend_from_slice(&states.1[..lanes]);
                motion.acceleration_m_per_s2.extend_from_slice(&states.2[..lanes]);
                for (series, derivative) in series.iter().zip(&mut derivatives) {
                    for change in &series.waves(step, tau, &states)[..lanes] {
                        derivative[0].push(*change);
                    }
                }
            }
            for (series, change) in series.iter().zip(&mut changes) {
                *change = series.end(step);
            }
            next < at.samples
        })?;
        Ok(Sensitivity { motions: vec![motion], derivatives })
    }
}

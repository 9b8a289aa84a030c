//! Derivatives of the nonlinear motions: the variational equation along the Taylor series of the motion.

use crate::curve::{Curve, Knot};
use crate::secant_motion::SecantMotion;
use crate::secant_step::{LANES, Law, ORDER, Step};
use crate::{Instants, LumpedError, Motion, Sensitivity};

/// A small change of the motion, at the start of a step.
#[derive(Debug, Clone, Copy, Default)]
struct Change {
    x: f64,
    v: f64,
}

/// Parameters whose changes are expanded side by side: each sum of products is a chain that waits for itself, and four of them fill
/// the time.
const ABREAST: usize = 4;

/// The changes over a step by a few parameters, as series: coefficients by order, then by parameter.
struct Series {
    x: [[f64; ABREAST]; ORDER + 1],
    v: [[f64; ABREAST]; ORDER + 1],
    /// What each parameter changes in the law.
    laws: [Law; ABREAST],
}

impl Series {
    /// Displacement, velocity and acceleration of the change by one of the parameters, at several times after the step's start, where
    /// the motion itself has `states`.
    fn waves(
        &self,
        parameter: usize,
        step: &Step,
        tau: [f64; LANES],
        states: &([f64; LANES], [f64; LANES], [f64; LANES]),
    ) -> [[f64; LANES]; 3] {
        let (mut x, mut v) = ([0.0; LANES], [0.0; LANES]);
        for (of_x, of_v) in self.x.iter().zip(&self.v).rev() {
            for lane in 0..LANES {
                x[lane] = x[lane] * tau[lane] + of_x[parameter];
                v[lane] = v[lane] * tau[lane] + of_v[parameter];
            }
        }
        let law = &step.law;
        let acceleration = std::array::from_fn(|lane| {
            let (sx, sv) = (states.0[lane], states.1[lane]);
            let own = (law.k0 + 2.0 * law.k1 * sx) * x[lane] + (law.c0 + 2.0 * law.c1 * sv) * v[lane];
            self.laws[parameter].acceleration(sx, sv) - own
        });
        [x, v, acceleration]
    }

    /// Displacement and velocity of the changes at the end of the step.
    fn end(&self, step: &Step) -> [Change; ABREAST] {
        let at = |series: &[[f64; ABREAST]; ORDER + 1]| {
            let mut sum = [0.0; ABREAST];
            for terms in series.iter().rev() {
                for (sum, term) in sum.iter_mut().zip(terms) {
                    *sum = *sum * step.length_s + term;
                }
            }
            sum
        };
        let (x, v) = (at(&self.x), at(&self.v));
        std::array::from_fn(|p| Change { x: x[p], v: v[p] })
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
    fn series(&self, step: &Step, start: [Change; ABREAST], laws: [Law; ABREAST]) -> Series {
        let none = [[0.0; ABREAST]; ORDER + 1];
        let mut found = Series { x: none, v: none, laws };
        (found.x[0], found.v[0]) = (start.map(|change| change.x), start.map(|change| change.v));
        let now = &step.law;
        for k in 0..ORDER {
            let (mut with_x, mut with_v) = ([0.0; ABREAST], [0.0; ABREAST]);
            let of_step = step.x[..=k].iter().zip(&step.v[..=k]);
            let of_change = found.x[..=k].iter().zip(&found.v[..=k]).rev();
            for ((sx, sv), (x, v)) in of_step.zip(of_change) {
                for p in 0..ABREAST {
                    with_x[p] += sx * x[p];
                    with_v[p] += sv * v[p];
                }
            }
            let by = 1.0 / (k + 1) as f64;
            for p in 0..ABREAST {
                let (x, v, law) = (found.x[k][p], found.v[k][p], &laws[p]);
                let own = now.k0 * x + 2.0 * now.k1 * with_x[p] + now.c0 * v + 2.0 * now.c1 * with_v[p];
                let forced = law.k0 * step.x[k] + law.k1 * self.xx[k] + law.c0 * step.v[k] + law.c1 * self.vv[k];
                found.x[k + 1][p] = v * by;
                found.v[k + 1][p] = -(own + forced) * by;
            }
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
        let mut derivatives: Vec<Vec<Motion>> =
            parameters.iter().map(|_| vec![Motion::with_capacity(at.samples)]).collect();
        let blocks = parameters.len().div_ceil(ABREAST);
        let mut changes = vec![[Change::default(); ABREAST]; blocks];
        let mut next = 0;
        let end_s = at.first_s + at.dt_s * at.samples as f64;
        let time = |k: usize| at.first_s + k as f64 * at.dt_s;
        // Series of the parameters' changes over a step, and blocks of its instants; kept to be filled again.
        let mut series = Vec::with_capacity(blocks);
        self.walk(impact_speed_m_per_s, end_s, |step| {
            let stop = step.start_s + step.length_s;
            let first = next;
            while next < at.samples && time(next) <= stop {
                next += 1;
            }
            series.clear();
            if !parameters.is_empty() {
                let products = Products::of(step);
                // Places of a last block that no parameter fills change nothing.
                let none = Law { k0: 0.0, k1: 0.0, c0: 0.0, c1: 0.0 };
                let laws = |block: &[usize]| -> [Law; ABREAST] {
                    std::array::from_fn(|p| block.get(p).map_or(none, |place| self.change_of_law(step, *place)))
                };
                let of_blocks = parameters.chunks(ABREAST).zip(&changes);
                series.extend(of_blocks.map(|(block, change)| products.series(step, *change, laws(block))));
            }
            for block in (first..next).step_by(LANES) {
                let tau = std::array::from_fn(|lane| time(block + lane) - step.start_s);
                let states = step.waves(tau);
                // Lanes beyond the step are not used.
                let lanes = LANES.min(next - block);
                motion.displacement_m.extend_from_slice(&states.0[..lanes]);
                motion.velocity_m_per_s.extend_from_slice(&states.1[..lanes]);
                motion.acceleration_m_per_s2.extend_from_slice(&states.2[..lanes]);
                for (k, derivative) in derivatives.iter_mut().enumerate() {
                    let [x, v, a] = series[k / ABREAST].waves(k % ABREAST, step, tau, &states);
                    derivative[0].displacement_m.extend_from_slice(&x[..lanes]);
                    derivative[0].velocity_m_per_s.extend_from_slice(&v[..lanes]);
                    derivative[0].acceleration_m_per_s2.extend_from_slice(&a[..lanes]);
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

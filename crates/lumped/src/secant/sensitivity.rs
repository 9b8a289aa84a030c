//! Derivatives of the nonlinear motions: the variational equation along the Taylor series of the motion.
//!
//! A small change `y` of the motion by a parameter p obeys `y'' = -(k0 + 2 k1 x) y - (c0 + 2 c1 v) y' - f`, where `f`
//! is what p changes in the force of the piece at the motion itself. Over a step of the motion all factors are known
//! series, so `y` gets its own series by the same recurrence, on the same steps. At a border of two pieces the force is
//! continuous, therefore so are `y` and `y'`: a parameter that moves a knot changes the law on either side of it and
//! adds no jump.
//!
//! Several parameters are expanded side by side ([`ABREAST`]). The derivatives are those of the motion as computed,
//! right to rounding; an acceleration has a kink at a knot, where one of its two one-sided derivatives is given.

use pulp::{Arch, Simd, WithSimd};

use crate::secant::curve::{Curve, Knot};
use crate::secant::single_mass::SecantMotion;
use crate::secant::step::{Blocks, Law, ORDER, Step, put, times, work_through};
use crate::{Instants, LumpedError, Motion, Sensitivity};

/// A small change of the motion, at the start of a step.
#[derive(Debug, Clone, Copy, Default)]
struct Change {
    x: f64,
    v: f64,
}

/// Parameters whose changes are expanded side by side: each sum of products is a chain that waits for itself, and the
/// others fill the time.
const ABREAST: usize = 8;

/// The changes over a step by a few parameters, as series: coefficients by order, then by parameter.
struct Series {
    x: [[f64; ABREAST]; ORDER + 1],
    v: [[f64; ABREAST]; ORDER + 1],
    /// What each parameter changes in the law.
    laws: [Law; ABREAST],
}

impl Series {
    /// Displacement, velocity and acceleration of the change by one of the parameters, at several times after the
    /// step's start, where the motion itself has `states`.
    #[inline(always)]
    fn waves<const L: usize>(
        &self,
        parameter: usize,
        step: &Step,
        tau: &[f64; L],
        [sx, sv, _]: &[[f64; L]; 3],
    ) -> [[f64; L]; 3] {
        let (mut x, mut v) = ([0.0; L], [0.0; L]);
        for (of_x, of_v) in self.x.iter().zip(&self.v).rev() {
            for lane in 0..L {
                x[lane] = x[lane] * tau[lane] + of_x[parameter];
                v[lane] = v[lane] * tau[lane] + of_v[parameter];
            }
        }
        let (law, change) = (&step.law, &self.laws[parameter]);
        let mut acceleration = [0.0; L];
        for lane in 0..L {
            let (sx, sv) = (sx[lane], sv[lane]);
            let from_change = (law.k0 + 2.0 * law.k1 * sx) * x[lane] + (law.c0 + 2.0 * law.c1 * sv) * v[lane];
            acceleration[lane] = change.acceleration(sx, sv) - from_change;
        }
        [x, v, acceleration]
    }

    /// Displacement and velocity of the changes at the end of the step.
    #[inline(always)]
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

impl Products {
    /// `xx_k = sum x_i x_(k-i)`, and the same of the velocity.
    #[inline(always)]
    fn of_step(step: &Step) -> Self {
        let mut products = Self { xx: [0.0; ORDER + 1], vv: [0.0; ORDER + 1] };
        for i in 0..=ORDER {
            for j in 0..=ORDER - i {
                products.xx[i + j] += step.x[i] * step.x[j];
                products.vv[i + j] += step.v[i] * step.v[j];
            }
        }
        products
    }

    /// `y'' = -(k0 + 2 k1 x) y - (c0 + 2 c1 v) y' - (change of the law)`.
    #[inline(always)]
    fn series(&self, step: &Step, start: [Change; ABREAST], laws: [Law; ABREAST]) -> Series {
        let zeros = [[0.0; ABREAST]; ORDER + 1];
        let mut series = Series { x: zeros, v: zeros, laws };
        (series.x[0], series.v[0]) = (start.map(|change| change.x), start.map(|change| change.v));
        let now = &step.law;
        for k in 0..ORDER {
            let (mut with_x, mut with_v) = ([0.0; ABREAST], [0.0; ABREAST]);
            let of_step = step.x[..=k].iter().zip(&step.v[..=k]);
            let of_change = series.x[..=k].iter().zip(&series.v[..=k]).rev();
            for ((sx, sv), (x, v)) in of_step.zip(of_change) {
                for p in 0..ABREAST {
                    with_x[p] += sx * x[p];
                    with_v[p] += sv * v[p];
                }
            }
            let factor = 1.0 / (k + 1) as f64;
            for p in 0..ABREAST {
                let (x, v, law) = (series.x[k][p], series.v[k][p], &laws[p]);
                let from_change = now.k0 * x + 2.0 * now.k1 * with_x[p] + now.c0 * v + 2.0 * now.c1 * with_v[p];
                let forced = law.k0 * step.x[k] + law.k1 * self.xx[k] + law.c0 * step.v[k] + law.c1 * self.vv[k];
                series.x[k + 1][p] = v * factor;
                series.v[k + 1][p] = -(from_change + forced) * factor;
            }
        }
        series
    }
}

impl SecantMotion {
    /// What a parameter changes in the law of a step. Places: mass, values of the spring, its inner knots, values of
    /// the damper, its inner knots, last knot of the spring, last knot of the damper.
    ///
    /// The law is per unit of mass, `k/m` and `c/m`: a derivative by the mass is `-1/m` of all four numbers. A value or
    /// the place of a knot changes constant and slope of the pieces that end there ([`Curve::change_of_piece`]) and
    /// nothing else.
    fn change_of_law(&self, step: &Step, place: usize) -> Law {
        let (springs, dampers) = (self.spring.len(), self.damper.len());
        let per_mass = 1.0 / self.mass_kg;
        let knot = match place {
            0 => {
                let law = &step.law;
                return Law {
                    k0: -per_mass * law.k0,
                    k1: -per_mass * law.k1,
                    c0: -per_mass * law.c0,
                    c1: -per_mass * law.c1,
                };
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
        let unchanged = Law { k0: 0.0, k1: 0.0, c0: 0.0, c1: 0.0 };
        let change = |curve: &Curve, piece: usize, knot: Knot| curve.change_of_piece(piece, knot);
        match knot {
            (true, knot) => {
                let (constant, slope) = change(&self.spring, step.spring_piece, knot);
                Law { k0: per_mass * constant, k1: per_mass * slope * step.sign_x, ..unchanged }
            }
            (false, knot) => {
                let (constant, slope) = change(&self.damper, step.damper_piece, knot);
                Law { c0: per_mass * constant, c1: per_mass * slope * step.sign_v, ..unchanged }
            }
        }
    }

    /// Motion and derivatives at the instants; places as in the parameter names of the nonlinear models.
    ///
    /// `parameters` are places in the order of [`ModelKind::parameters`](crate::ModelKind::parameters); the derivatives
    /// come in the order asked for, one motion each, per SI unit of the parameter. Errors: as the motion.
    pub fn sensitivity(
        &self,
        impact_speed_m_per_s: f64,
        at: &Instants,
        parameters: &[usize],
    ) -> Result<Sensitivity, LumpedError> {
        let arch = Arch::new();
        let mut motion = Motion::zeros(at.samples);
        let mut derivatives = vec![vec![motion.clone()]; parameters.len()];
        let blocks = parameters.len().div_ceil(ABREAST);
        let mut changes = vec![[Change::default(); ABREAST]; blocks];
        let mut next = 0;
        let end_s = at.first_s + at.dt_s * at.samples as f64;
        let time = |k: usize| at.first_s + k as f64 * at.dt_s;
        // Series of the parameters' changes over a step, kept to be filled again.
        let mut series = Vec::with_capacity(blocks);
        // Places of a last block that no parameter fills change nothing.
        let unchanged = Law { k0: 0.0, k1: 0.0, c0: 0.0, c1: 0.0 };
        self.walk(impact_speed_m_per_s, end_s, |step| {
            let stop = step.start_s + step.length_s;
            let first = next;
            while next < at.samples && time(next) <= stop {
                next += 1;
            }
            let laws = |block: &[usize]| -> [Law; ABREAST] {
                std::array::from_fn(|p| block.get(p).map_or(unchanged, |place| self.change_of_law(step, *place)))
            };
            let laws = parameters.chunks(ABREAST).map(laws).collect();
            let (series, changes) = (&mut series, &mut changes);
            let (motion, derivatives) = (&mut motion, &mut derivatives);
            arch.dispatch(Expand { step, at, instants: (first, next), laws, series, changes, motion, derivatives });
            next < at.samples
        })?;
        Ok(Sensitivity { motions: vec![motion], derivatives })
    }
}

/// The motion and its changes over one step.
struct Expand<'a> {
    step: &'a Step,
    at: &'a Instants,
    /// The instants in the step, from .. to.
    instants: (usize, usize),
    /// What the parameters change in the law, block by block.
    laws: Vec<[Law; ABREAST]>,
    series: &'a mut Vec<Series>,
    /// Changes at the start of the step, and then at its end.
    changes: &'a mut [[Change; ABREAST]],
    motion: &'a mut Motion,
    derivatives: &'a mut [Vec<Motion>],
}

impl WithSimd for Expand<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        self.series.clear();
        if !self.laws.is_empty() {
            let products = Products::of_step(self.step);
            for (laws, change) in self.laws.iter().zip(&mut *self.changes) {
                let series = products.series(self.step, *change, *laws);
                *change = series.end(self.step);
                self.series.push(series);
            }
        }
        let from = self.instants.0;
        work_through::<S>(&mut self, from);
    }
}

impl Blocks for Expand<'_> {
    #[inline(always)]
    fn end(&self) -> usize {
        self.instants.1
    }

    #[inline(always)]
    fn block<const L: usize>(&mut self, from: usize) {
        let to = (from + L).min(self.end());
        let tau = times::<L>(self.at.first_s, self.at.dt_s, from, self.step);
        let states = self.step.waves(&tau);
        let put_all = |motion: &mut Motion, [x, v, a]: &[[f64; L]; 3]| {
            put(&mut motion.displacement_m[from..to], x);
            put(&mut motion.velocity_m_per_s[from..to], v);
            put(&mut motion.acceleration_m_per_s2[from..to], a);
        };
        put_all(self.motion, &states);
        for (k, derivative) in self.derivatives.iter_mut().enumerate() {
            let series = &self.series[k / ABREAST];
            put_all(&mut derivative[0], &series.waves(k % ABREAST, self.step, &tau, &states));
        }
    }
}

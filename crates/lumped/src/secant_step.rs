//! One step of a nonlinear motion: Taylor series on one piece of spring and damper.

use crate::State;

/// Terms of the Taylor series.
pub(crate) const ORDER: usize = 20;
/// Rest of the series after a step, relative to the motion.
pub(crate) const REST: f64 = 1e-17;
/// Instants evaluated side by side.
pub(crate) const LANES: usize = 8;

/// One step: the Taylor coefficients of the motion about its start, valid for `length`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    pub start_s: f64,
    pub length_s: f64,
    pub x: [f64; ORDER + 1],
    /// Those of its velocity.
    pub v: [f64; ORDER + 1],
    pub law: Law,
    /// Pieces of the two curves it lies on, and the signs there.
    pub spring_piece: usize,
    pub damper_piece: usize,
    pub sign_x: f64,
    pub sign_v: f64,
}

/// The force on the pieces a step lies in: `a = -((k0 + k1 sx x) x + (c0 + c1 sv v) v)`, per unit of mass.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Law {
    pub k0: f64,
    pub k1: f64,
    pub c0: f64,
    pub c1: f64,
}

impl Step {
    /// The state at `tau` after the step's start.
    #[inline]
    pub fn at(&self, tau: f64) -> State {
        let (mut x, mut v) = (0.0, 0.0);
        for (of_x, of_v) in self.x.iter().zip(&self.v).rev() {
            x = x * tau + of_x;
            v = v * tau + of_v;
        }
        State { displacement_m: x, velocity_m_per_s: v, acceleration_m_per_s2: self.law.acceleration(x, v) }
    }
}

impl Step {
    /// Series of the damper's power per unit of mass, `(c0 + c1 sv v) v²`.
    pub fn power(&self) -> [f64; ORDER + 1] {
        let product = |a: &[f64; ORDER + 1], b: &[f64; ORDER + 1]| -> [f64; ORDER + 1] {
            std::array::from_fn(|k| (0..=k).map(|i| a[i] * b[k - i]).sum())
        };
        let coefficient = std::array::from_fn(|k| self.law.c1 * self.v[k] + if k == 0 { self.law.c0 } else { 0.0 });
        product(&coefficient, &product(&self.v, &self.v))
    }

    /// The motion at `first dt`, `(first + 1) dt` and so on, as many as the slices hold: several instants at a time, which
    /// the processor works on side by side.
    pub fn fill(&self, first: usize, dt_s: f64, [x, v, a]: [&mut [f64]; 3]) {
        let tau = |at: usize| {
            let at = at as f64;
            std::array::from_fn(|lane| (at + lane as f64) * dt_s - self.start_s)
        };
        let whole = x.len() - x.len() % LANES;
        let blocks = x.as_chunks_mut::<LANES>().0.iter_mut().zip(v.as_chunks_mut::<LANES>().0);
        for (block, ((x, v), a)) in blocks.zip(a.as_chunks_mut::<LANES>().0).enumerate() {
            (*x, *v, *a) = self.waves(tau(first + block * LANES));
        }
        let rest = x.len() - whole;
        if rest > 0 {
            let (x_rest, v_rest, a_rest) = self.waves(tau(first + whole));
            x[whole..].copy_from_slice(&x_rest[..rest]);
            v[whole..].copy_from_slice(&v_rest[..rest]);
            a[whole..].copy_from_slice(&a_rest[..rest]);
        }
    }

    /// Displacement, velocity and acceleration at several instants.
    #[inline]
    pub fn waves(&self, tau: [f64; LANES]) -> ([f64; LANES], [f64; LANES], [f64; LANES]) {
        let (mut x, mut v) = ([0.0; LANES], [0.0; LANES]);
        for (of_x, of_v) in self.x.iter().zip(&self.v).rev() {
            for lane in 0..LANES {
                x[lane] = x[lane] * tau[lane] + of_x;
                v[lane] = v[lane] * tau[lane] + of_v;
            }
        }
        (x, v, std::array::from_fn(|lane| self.law.acceleration(x[lane], v[lane])))
    }
}

impl Law {
    #[inline]
    pub fn acceleration(&self, x: f64, v: f64) -> f64 {
        -((self.k0 + self.k1 * x) * x + (self.c0 + self.c1 * v) * v)
    }
}

impl Law {
    /// Series of displacement and velocity: `x[k+1] = v[k]/(k+1)`, `v[k+1] = a[k]/(k+1)`, products by convolution.
    pub fn series(&self, x0: f64, v0: f64) -> ([f64; ORDER + 1], [f64; ORDER + 1]) {
        let mut x = [0.0; ORDER + 1];
        let mut v = [0.0; ORDER + 1];
        (x[0], v[0]) = (x0, v0);
        for k in 0..ORDER {
            let (mut xx, mut vv) = (0.0, 0.0);
            // Every product but that of the middle term occurs twice.
            for i in 0..k.div_ceil(2) {
                xx += x[i] * x[k - i];
                vv += v[i] * v[k - i];
            }
            (xx, vv) = (2.0 * xx, 2.0 * vv);
            if k % 2 == 0 {
                xx += x[k / 2] * x[k / 2];
                vv += v[k / 2] * v[k / 2];
            }
            let a = -(self.k0 * x[k] + self.k1 * xx + self.c0 * v[k] + self.c1 * vv);
            let by = 1.0 / (k + 1) as f64;
            x[k + 1] = v[k] * by;
            v[k + 1] = a * by;
        }
        (x, v)
    }
}

/// The step after which the last terms of the velocity's series are `REST` of the motion.
pub(crate) fn longest(x: &[f64; ORDER + 1]) -> f64 {
    let size = x[0].abs().max(x[1].abs() * 1e-3).max(1e-12);
    let bound = |k: usize| (size * REST / x[k].abs().max(f64::MIN_POSITIVE)).powf(1.0 / k as f64);
    bound(ORDER).min(bound(ORDER - 1)).max(1e-9)
}

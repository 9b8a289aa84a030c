//! One step of a nonlinear motion: Taylor series on one piece of spring and damper.
//!
//! `x(tau) = sum x_k tau^k`, k up to [`ORDER`], about the start of the step. With
//! `a = -((k0 + k1 x) x + (c0 + c1 v) v)` the coefficients follow from `x_(k+1) = v_k/(k+1)` and `v_(k+1) = a_k/(k+1)`,
//! where the squares of `x` and `v` are convolutions of the coefficients known so far (the recurrence of Parker and
//! Sochacki). The step is as long as the two last terms stay below [`REST`] of the motion.
//!
//! Samples are evaluated by Horner's rule for several instants at once, so that the processor's vectors are full; every
//! lane does the operations of a single evaluation in the same order, hence the same bits for every vector width.

use pulp::{Simd, WithSimd};

use crate::State;

/// Terms of the Taylor series.
pub(crate) const ORDER: usize = 20;
/// Rest of the series after a step, relative to the motion.
pub(crate) const REST: f64 = 1e-17;
/// Instants evaluated side by side where few are wanted. Where there are many, as many as keep the processor's vectors
/// busy; the result is the same to the bit. What is compiled for wide vectors is written in plain loops: closures would
/// not be.
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
    ///
    /// Times the mass and integrated term by term it is the heat of the damper.
    pub fn power(&self) -> [f64; ORDER + 1] {
        let product = |a: &[f64; ORDER + 1], b: &[f64; ORDER + 1]| -> [f64; ORDER + 1] {
            std::array::from_fn(|k| (0..=k).map(|i| a[i] * b[k - i]).sum())
        };
        let coefficient = std::array::from_fn(|k| self.law.c1 * self.v[k] + if k == 0 { self.law.c0 } else { 0.0 });
        product(&coefficient, &product(&self.v, &self.v))
    }

    /// Displacement, velocity and acceleration at several instants.
    #[inline(always)]
    pub fn waves<const L: usize>(&self, tau: &[f64; L]) -> [[f64; L]; 3] {
        let (mut x, mut v) = ([0.0; L], [0.0; L]);
        for (of_x, of_v) in self.x.iter().zip(&self.v).rev() {
            for lane in 0..L {
                x[lane] = x[lane] * tau[lane] + of_x;
                v[lane] = v[lane] * tau[lane] + of_v;
            }
        }
        let mut a = [0.0; L];
        for lane in 0..L {
            a[lane] = self.law.acceleration(x[lane], v[lane]);
        }
        [x, v, a]
    }
}

/// Work over the instants of a step, several side by side.
pub(crate) trait Blocks {
    /// Where the instants end.
    fn end(&self) -> usize;

    /// Does those from `from` on, as many as `L` or as there are.
    fn block<const L: usize>(&mut self, from: usize);
}

/// All blocks from `from` on: as many instants at a time as keep the vectors of the processor busy, the last few by
/// themselves.
#[inline(always)]
pub(crate) fn work_through<S: Simd>(work: &mut impl Blocks, from: usize) {
    match size_of::<S::f64s>() {
        64 => in_blocks_of::<32>(work, from),
        32 => in_blocks_of::<16>(work, from),
        _ => in_blocks_of::<LANES>(work, from),
    }
}

#[inline(always)]
fn in_blocks_of<const L: usize>(work: &mut impl Blocks, mut from: usize) {
    let end = work.end();
    while end - from > LANES {
        work.block::<L>(from);
        from = (from + L).min(end);
    }
    if end > from {
        work.block::<LANES>(from);
    }
}

/// The motion of a step at `first_s + k dt_s`, k from `first` on, as many as the waves hold.
pub(crate) struct Fill<'a> {
    pub step: &'a Step,
    pub first_s: f64,
    pub dt_s: f64,
    pub first: usize,
    pub waves: [&'a mut [f64]; 3],
}

impl WithSimd for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        work_through::<S>(&mut self, 0);
    }
}

impl Blocks for Fill<'_> {
    #[inline(always)]
    fn end(&self) -> usize {
        self.waves[0].len()
    }

    #[inline(always)]
    fn block<const L: usize>(&mut self, from: usize) {
        let tau = times::<L>(self.first_s, self.dt_s, self.first + from, self.step);
        let values = self.step.waves(&tau);
        self.waves.iter_mut().zip(&values).for_each(|(wave, values)| put(&mut wave[from..], values));
    }
}

/// The instants from number `at` on, after the start of a step.
#[inline(always)]
pub(crate) fn times<const L: usize>(first_s: f64, dt_s: f64, at: usize, step: &Step) -> [f64; L] {
    let at = at as f64;
    let mut tau = [0.0; L];
    for (lane, tau) in tau.iter_mut().enumerate() {
        *tau = first_s + (at + lane as f64) * dt_s - step.start_s;
    }
    tau
}

/// Lanes beyond the end are not used.
#[inline(always)]
pub(crate) fn put<const L: usize>(wave: &mut [f64], values: &[f64; L]) {
    match wave.first_chunk_mut::<L>() {
        Some(all) => *all = *values,
        None => wave.copy_from_slice(&values[..wave.len()]),
    }
}

impl Law {
    /// `-((k0 + k1 x) x + (c0 + c1 v) v)`, m/s².
    #[inline(always)]
    pub fn acceleration(&self, x: f64, v: f64) -> f64 {
        -((self.k0 + self.k1 * x) * x + (self.c0 + self.c1 * v) * v)
    }
}

impl Law {
    /// Series of displacement and velocity: `x[k+1] = v[k]/(k+1)`, `v[k+1] = a[k]/(k+1)`, products by convolution.
    ///
    /// `x0` in m, `v0` in m/s; the result in m/s^k and m/s^(k+1). Some `ORDER²` products.
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
            let factor = 1.0 / (k + 1) as f64;
            x[k + 1] = v[k] * factor;
            v[k + 1] = a * factor;
        }
        (x, v)
    }
}

/// The step after which the last terms of the velocity's series are `REST` of the motion.
///
/// `tau` with `|x_k| tau^k = REST` times the size of the motion for the last and the last but one k: two, because the
/// coefficients of an even or odd function vanish in turn. Never below a nanosecond.
pub(crate) fn longest(x: &[f64; ORDER + 1]) -> f64 {
    let size = x[0].abs().max(x[1].abs() * 1e-3).max(1e-12);
    let bound = |k: usize| (size * REST / x[k].abs().max(f64::MIN_POSITIVE)).powf(1.0 / k as f64);
    bound(ORDER).min(bound(ORDER - 1)).max(1e-9)
}

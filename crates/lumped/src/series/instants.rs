//! Polynomials at the instants of a step.
//!
//! Horner's rule for several instants at once, so that the processor's vectors are full; every lane does the operations
//! of a single evaluation in the same order, hence the same bits for every vector width. What is compiled for wide
//! vectors is written in plain loops: closures would not be.

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use crate::series::step::{Series, Step};
use crate::structure::form::{Form, Strain};
use crate::{Instants, Motion};

/// The instants `first_s + k dt_s`, read off the steps of a motion one after the other.
pub(crate) struct Reader {
    at: Instants,
    /// Instants read so far.
    next: usize,
    arch: Arch,
}

impl Reader {
    /// None is read yet.
    pub fn new(at: &Instants) -> Self {
        Self { at: *at, next: 0, arch: Arch::new() }
    }

    /// Where the motion need not be followed further, s.
    pub fn end_s(&self) -> f64 {
        self.time(self.at.samples)
    }

    /// Instant number `k`, s.
    pub fn time(&self, k: usize) -> f64 {
        self.at.first_s + k as f64 * self.at.dt_s
    }

    /// Goes on over the instants in a step; their numbers.
    pub fn pass(&mut self, step: &Step) -> Range<usize> {
        let (from, stop) = (self.next, step.start_s + step.length_s);
        // A division finds the last but for rounding.
        let mut end = (((stop - self.at.first_s) / self.at.dt_s) as usize).clamp(from, self.at.samples);
        while end > from && self.time(end - 1) > stop {
            end -= 1;
        }
        while end < self.at.samples && self.time(end) <= stop {
            end += 1;
        }
        self.next = end;
        from..end
    }

    /// Whether instants are left.
    pub fn goes_on(&self) -> bool {
        self.next < self.at.samples
    }

    /// Displacement of a mass in `step` at the instants `at`, each at its place in the wave.
    pub fn fill_displacement(&self, step: &Step, at: &Range<usize>, mass: usize, wave: &mut [f64]) {
        self.fill(step, at, [&step.nodes[mass].x], [wave], None);
    }

    /// The motion of every mass in `step` at the instants `at`.
    pub fn fill_motions(&self, step: &Step, at: &Range<usize>, motions: &mut [Motion]) {
        let law = step.law_of_one_mass();
        for (node, motion) in step.nodes.iter().zip(motions) {
            let Motion { displacement_m: x, velocity_m_per_s: v, acceleration_m_per_s2: a } = motion;
            match law {
                Some(law) => self.fill(step, at, [&node.x, &node.v], [x, v], Some((law, a))),
                None => self.fill(step, at, [&node.x, &node.v, &node.a], [x, v, a], None),
            }
        }
    }

    /// A motion whose three waves have these series.
    pub fn fill_series(&self, step: &Step, at: &Range<usize>, [x, v, a]: &[Series; 3], motion: &mut Motion) {
        let Motion { displacement_m, velocity_m_per_s, acceleration_m_per_s2 } = motion;
        self.fill(step, at, [x, v, a], [displacement_m, velocity_m_per_s, acceleration_m_per_s2], None);
    }

    fn fill<const N: usize>(
        &self,
        step: &Step,
        at: &Range<usize>,
        series: [&Series; N],
        mut waves: [&mut [f64]; N],
        law: Option<(Form, &mut [f64])>,
    ) {
        let out = waves.each_mut().map(|wave| &mut wave[at.clone()]);
        let (first, clock) = (at.start, [self.at.first_s, self.at.dt_s, step.start_s]);
        let law = law.map(|(form, wave)| (form, &mut wave[at.clone()]));
        self.arch.dispatch(Fill { first, clock, series, out, law });
    }
}

/// Instants evaluated side by side where few are wanted. Where there are many, as many as keep the processor's vectors
/// busy.
const LANES: usize = 8;

/// Values of polynomials from instant number `first` on; `clock` holds the first instant, their spacing and the start
/// of the step.
struct Fill<'a, const N: usize> {
    first: usize,
    clock: [f64; 3],
    series: [&'a Series; N],
    out: [&'a mut [f64]; N],
    /// A form of the first two values, and where it goes.
    law: Option<(Form, &'a mut [f64])>,
}

impl<const N: usize> WithSimd for Fill<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        match size_of::<S::f64s>() {
            64 => self.in_blocks_of::<32>(),
            32 => self.in_blocks_of::<16>(),
            _ => self.in_blocks_of::<LANES>(),
        }
    }
}

impl<const N: usize> Fill<'_, N> {
    /// All instants, the last few by themselves.
    #[inline(always)]
    fn in_blocks_of<const L: usize>(&mut self) {
        let (mut from, end) = (0, self.out[0].len());
        while end - from > LANES {
            self.block::<L>(from);
            from = (from + L).min(end);
        }
        if end > from {
            self.block::<LANES>(from);
        }
    }

    #[inline(always)]
    fn block<const L: usize>(&mut self, from: usize) {
        let [first_s, dt_s, start_s] = self.clock;
        let mut tau = [0.0; L];
        for (lane, tau) in tau.iter_mut().enumerate() {
            *tau = first_s + (self.first + from + lane) as f64 * dt_s - start_s;
        }
        let mut values = [[0.0; L]; N];
        if N == 1 {
            values[0] = polynomial(self.series[0], &tau);
        } else {
            // Two side by side keep the processor busy.
            (values[0], values[1 % N]) = two_polynomials([self.series[0], self.series[1 % N]], &tau);
        }
        if N > 2 {
            values[2 % N] = polynomial(self.series[2 % N], &tau);
        }
        for (out, values) in self.out.iter_mut().zip(&values) {
            put(&mut out[from..], values);
        }
        if let Some((form, out)) = &mut self.law {
            let (u, w) = (values[0], values[1 % N]);
            let mut value = [0.0; L];
            for lane in 0..L {
                value[lane] = form.at(Strain { u: u[lane], w: w[lane], z: 0.0 });
            }
            put(&mut out[from..], &value);
        }
    }
}

/// Values of a polynomial.
#[inline(always)]
fn polynomial<const L: usize>(series: &Series, tau: &[f64; L]) -> [f64; L] {
    let mut sum = [0.0; L];
    for term in series.iter().rev() {
        for lane in 0..L {
            sum[lane] = sum[lane] * tau[lane] + term;
        }
    }
    sum
}

/// Values of two.
#[inline(always)]
fn two_polynomials<const L: usize>([a, b]: [&Series; 2], tau: &[f64; L]) -> ([f64; L], [f64; L]) {
    let (mut x, mut y) = ([0.0; L], [0.0; L]);
    for (of_x, of_y) in a.iter().zip(b).rev() {
        for lane in 0..L {
            x[lane] = x[lane] * tau[lane] + of_x;
            y[lane] = y[lane] * tau[lane] + of_y;
        }
    }
    (x, y)
}

/// Lanes beyond the end are not used.
#[inline(always)]
fn put<const L: usize>(out: &mut [f64], values: &[f64; L]) {
    match out.first_chunk_mut::<L>() {
        Some(all) => *all = *values,
        None => out.copy_from_slice(&values[..out.len()]),
    }
}

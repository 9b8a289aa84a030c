//! Polynomials at the instants of a step.
//!
//! Horner's rule for several instants at once, so that the processor's vectors are full; every lane does the operations
//! of a single evaluation in the same order, hence the same bits for every vector width. What is compiled for wide
//! vectors is written in plain loops: closures would not be.

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use crate::series::step::{ORDER, Series, Step, values};
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

    /// The motion of every mass in `step` at the instants `at`.
    pub fn fill_motions(&self, step: &Step, at: &Range<usize>, motions: &mut [Motion]) {
        let law = step.law_of_one_mass();
        for (node, motion) in step.nodes.iter().zip(motions) {
            let out = motion.waves_mut().map(|wave| wave.get_mut(at.clone()).unwrap_or_default());
            match out {
                // One wave and few instants: nothing is dispatched for them.
                [x, [], []] => {
                    for from in (0..x.len()).step_by(LANES) {
                        put(&mut x[from..], &values::<LANES>(&node.x, &self.since_start(step, at.start + from)));
                    }
                }
                out => self.fill(step, at, [&node.x, &node.v, &node.a], law, out),
            }
        }
    }

    /// Waves of which each has its series, three side by side.
    pub fn fill_waves(&self, step: &Step, at: &Range<usize>, mut waves: Vec<(Series, &mut [f64])>) {
        for three in waves.chunks_mut(3) {
            let mut three = three.iter_mut();
            let mut next =
                || three.next().map_or((&[0.0; ORDER + 1], &mut [][..]), |(series, out)| (&*series, &mut **out));
            let [(x, of_x), (v, of_v), (a, of_a)] = [next(), next(), next()];
            self.fill(step, at, [x, v, a], None, [of_x, of_v, of_a]);
        }
    }

    /// Waves of these series; the last by a form of the others, if there is one. What is empty stays so.
    fn fill(&self, step: &Step, at: &Range<usize>, series: [&Series; 3], law: Option<Form>, out: [&mut [f64]; 3]) {
        let length = at.len();
        self.arch.dispatch(Fill { reader: self, step, first: at.start, length, series, law, out });
    }

    /// Times after the start of a step of the instants from number `first` on.
    #[inline(always)]
    fn since_start<const L: usize>(&self, step: &Step, first: usize) -> [f64; L] {
        let mut tau = [0.0; L];
        for (lane, tau) in tau.iter_mut().enumerate() {
            *tau = self.at.first_s + (first + lane) as f64 * self.at.dt_s - step.start_s;
        }
        tau
    }
}

/// Instants evaluated side by side where few are wanted. Where there are many, as many as keep the processor's vectors
/// busy.
const LANES: usize = 8;

/// A motion over the instants of a step, from number `first` on.
struct Fill<'a> {
    reader: &'a Reader,
    step: &'a Step,
    first: usize,
    length: usize,
    series: [&'a Series; 3],
    law: Option<Form>,
    out: [&'a mut [f64]; 3],
}

impl WithSimd for Fill<'_> {
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

impl Fill<'_> {
    /// All instants, the last few by themselves.
    #[inline(always)]
    fn in_blocks_of<const L: usize>(&mut self) {
        let (mut from, end) = (0, self.length);
        while end - from > 2 * LANES {
            self.block::<L>(from);
            from = (from + L).min(end);
        }
        match end - from {
            0 => {}
            1..=LANES => self.block::<LANES>(from),
            _ => self.block::<{ 2 * LANES }>(from),
        }
    }

    #[inline(always)]
    fn block<const L: usize>(&mut self, from: usize) {
        let tau = self.reader.since_start::<L>(self.step, self.first + from);
        let [x, v, a] = self.series;
        // Side by side, so that the processor is busy.
        let (mut u, mut w, mut acceleration) = ([0.0; L], [0.0; L], [0.0; L]);
        match &self.law {
            Some(law) => {
                for (of_x, of_v) in x.iter().zip(v).rev() {
                    for lane in 0..L {
                        u[lane] = u[lane] * tau[lane] + of_x;
                        w[lane] = w[lane] * tau[lane] + of_v;
                    }
                }
                for lane in 0..L {
                    acceleration[lane] = law.at(Strain { u: u[lane], w: w[lane], z: 0.0 });
                }
            }
            None => {
                for ((of_x, of_v), of_a) in x.iter().zip(v).zip(a).rev() {
                    for lane in 0..L {
                        u[lane] = u[lane] * tau[lane] + of_x;
                        w[lane] = w[lane] * tau[lane] + of_v;
                        acceleration[lane] = acceleration[lane] * tau[lane] + of_a;
                    }
                }
            }
        }
        for (out, values) in self.out.iter_mut().zip([&u, &w, &acceleration]) {
            put(out.get_mut(from..).unwrap_or_default(), values);
        }
    }
}

/// Lanes beyond the end are not used.
#[inline(always)]
fn put<const L: usize>(out: &mut [f64], values: &[f64; L]) {
    match out.first_chunk_mut::<L>() {
        Some(all) => *all = *values,
        None => out.copy_from_slice(&values[..out.len()]),
    }
}

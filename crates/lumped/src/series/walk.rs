//! The way from event to event: steps, exits from laws, the answers at instants.
//!
//! The walk from event to event.
//!
//! A step ends where a guard of an element falls through zero (Newton's method on the series), so no step contains a
//! kink of a force, and at every sample of a drive, whose slope changes there. What a step costs: some 20² products for
//! each square in a force, an estimate of how far the series holds, and, only where a guard can be met within the step
//! at all, a search for the instant. Stiff dampers shorten the steps to their time constant; after [`MAX_STEPS`] the
//! motion is given up.
//!
//! Where a step leaves the branches it was made on.
//!
//! Which branches hold from an event on is asked of the series: a guard that is zero at the start must become positive
//! first, or its branch ends there and the series is made again. A guard closer to zero than [`ON_A_GUARD`] of the
//! motion counts as zero, because a difference of two displacements is no better known.
//!
//! Polynomials at the instants of a step.
//!
//! Horner's rule for several instants at once, so that the processor's vectors are full; every lane does the operations
//! of a single evaluation in the same order, hence the same bits for every vector width. What is compiled for wide
//! vectors is written in plain loops: closures would not be.

use std::cell::Cell;
use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use crate::exact::crossing::falling_zero;
use crate::series::changes::Changes;
use crate::series::expression_series::ExpressionSeries;
use crate::series::step::{
    Entry, Input, LinkSeries, NOTHING_M, ORDER, PARTS, Series, Step, horner, largest, turns, value, values,
};
use crate::structure::connected_masses::{Form, Guard, Place, Strain, Structure};
use crate::{Drive, Instants, LumpedError, Motion, Start};

/// Steps after which the motion is given up.
const MAX_STEPS: usize = 200_000;

thread_local! {
    static STEPS: Cell<u64> = const { Cell::new(0) };
}

/// Steps that motions on this thread have taken so far: before and after a motion, what it cost.
pub fn steps_taken() -> u64 {
    STEPS.get()
}

/// A motion on its way.
pub(crate) struct Walk<'a> {
    structure: &'a Structure,
    pub step: Step,
    guards: Vec<LinkGuard>,
    changes: Changes,
}

impl Walk<'_> {
    /// The guards of the branches as they are.
    fn gather_guards(&mut self) {
        self.guards.clear();
        for (link, (connection, branch)) in self.structure.connections().iter().zip(&self.step.branches).enumerate() {
            connection.element.law().guards(branch, &mut |guard| self.guards.push(LinkGuard { link, guard }));
        }
    }

    /// Takes an element to its next branch, at the start of the step to come.
    fn enter(&mut self, exit: LinkGuard) {
        let LinkGuard { link, guard } = exit;
        let (law, strain) = (self.structure.connections()[link].element.law(), self.step.strain_now(link));
        let before = self.step.branches[link];
        self.changes.enter(law, link, &before, strain, self.step.links[link].nodes);
        let after = law.enter(&before, guard.next, strain);
        self.step.entered.push(Entry { link, before, after });
        self.step.branches[link] = after;
        self.step.links[link].law = law.force(&after);
        self.step.own[link] = ExpressionSeries::of_element(law, &after);
        self.gather_guards();
    }

    /// The series from the values at the start, on the branches that the motion enters; how long it holds.
    fn expand(&mut self, longest_s: f64) -> (f64, Tolerance) {
        let mut tries = 0;
        loop {
            self.step.expand();
            let reach_s = self.step.longest().min(longest_s);
            let near = Tolerance::of_step(&self.step, reach_s);
            tries += 1;
            // Each branch can move the motion onto another; more changes than there are elements decide nothing.
            match ends_at_once(&self.step, &self.guards, reach_s, near) {
                Some(exit) if tries <= 4 * self.step.links.len() + 4 => self.enter(exit),
                _ => return (reach_s, near),
            }
        }
    }

    /// Walks on to `end_s`, see [`walk`].
    pub fn follow(
        &mut self,
        drive: &Drive,
        dt_s: f64,
        end_s: f64,
        mut visit: impl FnMut(&Step, &Changes) -> bool,
    ) -> Result<(), LumpedError> {
        self.gather_guards();
        let mass = drive.force().map(|(mass, _)| mass);
        let mut number = 0;
        for _ in 0..MAX_STEPS {
            let t = self.step.start_s;
            if t >= end_s {
                return Ok(());
            }
            STEPS.set(STEPS.get() + 1);
            let stretch = drive.stretch(number, dt_s);
            let until = stretch.map_or(end_s, |(_, until)| end_s.min(until));
            self.step.input = stretch.map_or(Input::default(), |(course, _)| Input::of_course(mass, &course, t));
            let (reach_s, near) = self.expand(until - t);
            if !self.step.is_finite() {
                return Err(LumpedError::ChainDiverges { time_s: t });
            }
            let exit = first_exit(&self.step, &self.guards, reach_s, near);
            self.step.length_s = exit.map_or(reach_s, |(tau, _)| tau);
            self.changes.expand(self.structure, &self.step);
            if !visit(&self.step, &self.changes) {
                return Ok(());
            }
            self.step.entered.clear();
            self.changes.advance(self.step.length_s);
            self.step.advance();
            if let Some((_, exit)) = exit {
                self.enter(exit);
            } else if self.step.start_s >= until * (1.0 - f64::EPSILON) {
                self.step.start_s = until;
            }
            if stretch.is_some_and(|(_, until)| self.step.start_s >= until) {
                number += 1;
            }
        }
        Err(LumpedError::ChainDiverges { time_s: self.step.start_s })
    }
}

impl<'a> Walk<'a> {
    /// At the start, with the derivatives by the parameters at `places`.
    pub fn new(structure: &'a Structure, start: &Start, places: &[Place]) -> Self {
        let changes = Changes::at_start(structure, places);
        Self { structure, step: Step::at_start(structure, start), guards: Vec::new(), changes }
    }
}

/// Walks from the start to `end_s`, with the derivatives by the parameters at `places`; `visit` returns whether to go
/// on. The samples of `drive` are `dt_s` apart.
///
/// Errors: a motion that leaves the range of numbers or needs more than 200,000 steps, as
/// [`LumpedError::ChainDiverges`] with the time reached.
pub(crate) fn walk(
    structure: &Structure,
    drive: &Drive,
    dt_s: f64,
    end_s: f64,
    places: &[Place],
    visit: impl FnMut(&Step, &Changes) -> bool,
) -> Result<(), LumpedError> {
    Walk::new(structure, &drive.start(), places).follow(drive, dt_s, end_s, visit)
}

/// Share of a step within which a guard that is zero at its start must become positive.
const INSIDE: f64 = 1.0 / 16.0;
/// That share is looked at from its four-thousandth on, each time four times as far: what comes back within it counts.
const LOOKS: i32 = 6;
/// A guard is zero if it is nearer than this, relative to the motion: rounding of a difference of displacements.
const ON_A_GUARD: f64 = 1e-13;

/// A guard with the element it belongs to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinkGuard {
    pub link: usize,
    pub guard: Guard,
}

/// How near to zero a compression and a rate are nothing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tolerance {
    u: f64,
    w: f64,
}

impl Tolerance {
    /// That of a step of this length.
    pub fn of_step(step: &Step, length_s: f64) -> Self {
        let (x, v) =
            (largest(step.nodes.iter().map(|node| node.x[0])), largest(step.nodes.iter().map(|node| node.v[0])));
        Self { u: ON_A_GUARD * (x + v * length_s), w: ON_A_GUARD * (v + NOTHING_M / length_s) }
    }

    /// That of a form.
    fn of_form(&self, form: &Form, link: &LinkSeries) -> f64 {
        let (u, w) = (link.u[0].abs(), link.w[0].abs());
        (form.u.abs() + 2.0 * form.uu.abs() * u + form.uw.abs() * w) * self.u
            + (form.w.abs() + 2.0 * form.ww.abs() * w + form.uw.abs() * u) * self.w
    }
}

/// Farthest that a series gets from its start, with the powers of the length of the step from the first on. In four
/// sums that need not wait for each other.
fn reach(series: &Series, powers: &[f64; ORDER]) -> f64 {
    let mut sums = [0.0; 4];
    for (terms, powers) in series[1..].chunks_exact(4).zip(powers.chunks_exact(4)) {
        for lane in 0..4 {
            sums[lane] += terms[lane].abs() * powers[lane];
        }
    }
    sums.iter().sum()
}

/// What an element feels at the start of a step.
fn now(link: &LinkSeries) -> Strain {
    Strain { u: link.u[0], w: link.w[0], z: link.z[0] }
}

/// The first guard that is zero at the start and falls below.
fn ends_at_once(step: &Step, guards: &[LinkGuard], reach_s: f64, near: Tolerance) -> Option<LinkGuard> {
    let falls = |guard: &&LinkGuard| {
        let (form, link) = (&guard.guard.form, &step.links[guard.link]);
        let near = near.of_form(form, link);
        form.at(now(link)) <= near && leaves_zero(form, link, reach_s, near).1 < -near
    };
    guards.iter().find(falls).copied()
}

/// Where a form that is zero at the start is something first, and what.
fn leaves_zero(form: &Form, link: &LinkSeries, reach_s: f64, near: f64) -> (f64, f64) {
    let look = |k: i32| {
        let tau = reach_s * INSIDE * 0.25_f64.powi(k);
        (tau, form.at(link.strain(tau)))
    };
    (1..=LOOKS).rev().map(look).find(|(_, value)| value.abs() > near).unwrap_or_else(|| look(0))
}

/// Where a guard first falls through zero within `length` seconds: the instant and the guard. `None` if all stay
/// positive.
fn first_exit(step: &Step, guards: &[LinkGuard], length: f64, near: Tolerance) -> Option<(f64, LinkGuard)> {
    let mut exit = None;
    let mut first = length;
    let mut power = 1.0;
    let powers: [f64; ORDER] = std::array::from_fn(|_| {
        power *= length;
        power
    });
    let mut farthest = (usize::MAX, (0.0, 0.0));
    for guard in guards {
        let (form, link) = (&guard.guard.form, &step.links[guard.link]);
        // Farthest the element can go in the step: most steps meet no guard, and this tells at once.
        if farthest.0 != guard.link {
            farthest = (guard.link, (reach(&link.u, &powers), reach(&link.w, &powers)));
        }
        let (u, w) = farthest.1;
        let (start, is_straight) =
            (form.at(now(link)), form.z == 0.0 && form.uu == 0.0 && form.ww == 0.0 && form.uw == 0.0);
        if is_straight && start > form.u.abs() * u + form.w.abs() * w {
            continue;
        }
        let series = link.series(form);
        // On a guard the motion was found to go inwards; it may be back soon.
        let near = near.of_form(form, link);
        let from = match length * INSIDE {
            _ if start > near => 0.0,
            inside if value(&series, inside) > 0.0 => inside,
            _ => leaves_zero(form, link, length, near).0,
        };
        let parts: [f64; PARTS] = std::array::from_fn(|part| first * (part + 1) as f64 / PARTS as f64);
        let is_beyond = values(&series, &parts).map(|distance| distance < 0.0);
        let part = (0..PARTS).find(|part| parts[*part] > from && is_beyond[*part]);
        let beyond = part.map(|part| (parts[..part].last().copied().unwrap_or(0.0).max(from), parts[part]));
        // Out and back between two looks.
        let mut dip = None;
        turns(&series, from, &parts, part.unwrap_or(PARTS), |low, bottom, is_lowest| {
            if is_lowest && dip.is_none() && value(&series, bottom) < -near {
                dip = Some((low, bottom));
            }
        });
        let Some((low, high)) = dip.or(beyond) else { continue };
        first = falling_zero(low, high, |tau| horner(&series, tau));
        exit = Some((first, *guard));
    }
    exit
}

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
                [[], [], []] => {}
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

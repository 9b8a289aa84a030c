//! How an acceleration becomes a wave of the artifact: sampling, channel filter, integration; the same done to a
//! model.
//!
//! All steps are linear, so the derivative of a measured motion by a parameter is the measurement of the derivative
//! of the acceleration, with no impact speed. Eight waves go through side by side: filter and sums are recursions
//! that wait for themselves. Where the steps are not known, the motion itself is compared.

use crumple_lumped::{Instants, LumpedError, Model, Place, Structure};
use crumple_signal::{BeforeEvent, RecordingSteps, Sampled};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::FitQuantity;
use crate::record::sensor::{motion_of, response_of};

/// A filter of second order that is run forward and backward over the record, as the filter stage records it (ISO
/// 6487, SAE J211).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoPassFilter {
    /// a0, a1, a2, b1, b2 of `y[i] = a0 x[i] + a1 x[i-1] + a2 x[i-2] + b1 y[i-1] + b2 y[i-2]`.
    pub coefficients: [f64; 5],
    /// Samples mirrored through the end points before filtering; 0: started from rest.
    pub samples_added: usize,
}

/// Rule by which acceleration is summed to velocity and displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IntegrationRule {
    /// Trapezoids.
    Trapezoid,
    /// The first paper's: every sample holds until the next.
    ForwardEuler,
    /// No sum and no filter: the motion itself, as an exact instrument shows it. Stands for steps that are not known,
    /// or not made.
    Exact,
}

/// Everything between the motion of the vehicle and a wave that a fit sees.
///
/// A model that goes through the same steps differs from the record by what it does not describe, and not by what a
/// filter does to the jump of acceleration at contact (some 1e-5 m at CFC 60) or a sum to an integral (1e-6 m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// Sampling interval, s.
    pub dt_s: f64,
    /// First sample of the acceleration, s after contact; negative before it.
    pub first_s: f64,
    /// Samples of the acceleration.
    pub samples: usize,
    /// The channel filter; `None`: not filtered.
    pub filter: Option<TwoPassFilter>,
    /// Whether the integration starts at contact (else at the first sample), with the impact speed.
    pub from_contact: bool,
    /// Its rule.
    pub rule: IntegrationRule,
    /// What the filtered acceleration shows before the event, m/s²; `None`: not known.
    pub before_event: Option<BeforeEvent>,
}

/// Share to which a filter's memory has to fall before it is neglected: 1e-10 of 1000 m/s² over 10 ms moves no
/// displacement by 1e-11 m.
const FORGOTTEN: f64 = 1e-10;
/// Samples of which the mean starts a pass, as in the filter stage.
const START_SAMPLES: usize = 10;
/// Waves that go through a measurement side by side.
const ABREAST: usize = 8;
/// A sample this close to contact is at contact, in intervals: rounding of decimal time stamps.
const ON_GRID: f64 = 1e-6;

impl From<RecordingSteps> for Measurement {
    /// The steps repeated; where not all of them are known, the motion itself.
    fn from(steps: RecordingSteps) -> Self {
        let measurement = Self {
            dt_s: steps.dt_s,
            first_s: steps.first_s,
            samples: steps.samples,
            filter: steps
                .two_pass_filter
                .map(|(coefficients, samples_added)| TwoPassFilter { coefficients, samples_added }),
            from_contact: steps.from_contact,
            rule: if steps.forward_euler { IntegrationRule::ForwardEuler } else { IntegrationRule::Trapezoid },
            before_event: steps.before_event,
        };
        if steps.known { measurement } else { measurement.exact() }
    }
}

impl Measurement {
    /// Index of the first sample at or after contact.
    pub fn contact_index(&self) -> usize {
        (-self.first_s / self.dt_s - ON_GRID).ceil().max(0.0) as usize
    }

    /// Time of a sample after contact, s.
    pub fn time_s(&self, index: usize) -> f64 {
        let t = self.first_s + index as f64 * self.dt_s;
        if t.abs() < ON_GRID * self.dt_s { 0.0 } else { t }
    }

    /// The displacement that this measurement makes of a model's compartment, from the first sample of the record to
    /// sample `last`; before the start of an integration from contact it is zero.
    ///
    /// Between the model's instants (contact and whole intervals after it) its acceleration is taken as linear, which
    /// matters only where contact lies between two samples: an error of `dt² max|a''|/8`. Errors: the model's own.
    pub fn displacement(&self, model: &Model, v0_m_per_s: f64, last: usize) -> Result<Vec<f64>, LumpedError> {
        self.motion(model, None, FitQuantity::Displacement, v0_m_per_s, last)
    }

    /// The same for any mass (by its index from the barrier on; `None`: the compartment, also for an index beyond it)
    /// and quantity: the acceleration is what the filter makes of it, the velocity its first sum.
    pub fn motion(
        &self,
        model: &Model,
        mass: Option<usize>,
        quantity: FitQuantity,
        v0_m_per_s: f64,
        last: usize,
    ) -> Result<Vec<f64>, LumpedError> {
        self.of_structure((mass, quantity), v0_m_per_s, last, &model.structure()?)
    }

    /// The same record of which the steps are not known: the motion itself is compared.
    #[must_use]
    pub fn exact(self) -> Self {
        Self { filter: None, rule: IntegrationRule::Exact, ..self }
    }

    /// Samples of a motion itself, contact at `time_zero_s` of its axis.
    pub fn of_samples(record: &Sampled, time_zero_s: f64) -> Self {
        Self {
            dt_s: record.dt_s(),
            first_s: record.t0_s() - time_zero_s,
            samples: record.len(),
            filter: None,
            from_contact: true,
            rule: IntegrationRule::Exact,
            before_event: None,
        }
    }

    /// Whether the motion itself is compared.
    pub fn is_exact(&self) -> bool {
        self.rule == IntegrationRule::Exact
    }

    /// [`Self::motion`] of any structure.
    pub fn of_structure(
        &self,
        (mass, quantity): (Option<usize>, FitQuantity),
        v0_m_per_s: f64,
        last: usize,
        structure: &Structure,
    ) -> Result<Vec<f64>, LumpedError> {
        let respond = |quantity, at: Instants| response_of(quantity, structure, v0_m_per_s, &at, &[]);
        let Some(samples) = self.samples_of_the_model(last) else {
            return Ok(self.seen(&[], quantity, v0_m_per_s, last));
        };
        if self.is_exact() {
            let before = self.contact_index();
            let samples = (last + 1).saturating_sub(before);
            let at = Instants { first_s: self.time_s(before).max(0.0), dt_s: self.dt_s, samples };
            let motions = respond(quantity, at)?.motions;
            let mut seen = vec![if quantity == FitQuantity::Velocity { v0_m_per_s } else { 0.0 }; before];
            seen.extend(motion_of(&motions, mass).map_or(&[][..], |motion| quantity.of(motion)));
            return Ok(seen);
        }
        let at = Instants { first_s: 0.0, dt_s: self.dt_s, samples };
        let motions = respond(quantity.recorded(), at)?.motions;
        let acceleration = motion_of(&motions, mass).map_or(&[][..], |m| &m.acceleration_m_per_s2);
        Ok(self.seen(acceleration, quantity, v0_m_per_s, last))
    }

    /// Derivatives of that by the parameters at these places: a measurement is linear, so they are the derivatives of
    /// the acceleration measured without an impact speed. Not of an exact one.
    pub(crate) fn derivatives(
        &self,
        (mass, quantity): (Option<usize>, FitQuantity),
        v0_m_per_s: f64,
        last: usize,
        (structure, places): (&Structure, &[Place]),
    ) -> Result<Vec<Vec<f64>>, LumpedError> {
        let Some(samples) = self.samples_of_the_model(last) else {
            return Ok(places.iter().map(|_| self.seen(&[], quantity, 0.0, last)).collect());
        };
        let at = Instants { first_s: 0.0, dt_s: self.dt_s, samples };
        let of_some = |places: &[Place]| -> Result<Vec<Vec<f64>>, LumpedError> {
            let response = response_of(quantity.recorded(), structure, v0_m_per_s, &at, places)?;
            let motions = response.derivatives.iter().map(|motions| motion_of(motions, mass));
            let accelerations: Vec<&[f64]> =
                motions.map(|motion| motion.map_or(&[][..], |motion| &motion.acceleration_m_per_s2)).collect();
            Ok(self.all_seen(&accelerations, quantity, last))
        };
        // In parts of equal size, on as many threads as are idle.
        let parts = places.len().div_ceil(ABREAST).max(1);
        let size = places.len().div_ceil(parts).max(1);
        let parts: Vec<Vec<Vec<f64>>> = places.par_chunks(size).map(of_some).collect::<Result<_, _>>()?;
        Ok(parts.into_iter().flatten().collect())
    }

    /// Number of samples of the acceleration that sample `last` of the record depends on: the backward pass of a
    /// filter looks ahead.
    fn reach(&self, last: usize) -> usize {
        let memory = self.filter.as_ref().map_or(0, TwoPassFilter::memory_samples);
        last.min(self.samples.saturating_sub(1)).saturating_add(memory).saturating_add(1).min(self.samples)
    }

    /// Instants of the model from contact on that these samples lie between; `None` if all of them are before contact.
    fn samples_of_the_model(&self, last: usize) -> Option<usize> {
        self.reach(last).checked_sub(self.contact_index()).filter(|n| *n > 0).map(|n| n + 1)
    }

    /// What is recorded of an acceleration, m/s², given at contact and at whole intervals after it.
    fn seen(&self, acceleration: &[f64], quantity: FitQuantity, v0_m_per_s: f64, last: usize) -> Vec<f64> {
        let [seen] = self.seen_together([acceleration], quantity, v0_m_per_s, last);
        seen
    }

    /// The same of many of equal length, several at a time: filter and integration wait for themselves, not for the
    /// processor.
    fn all_seen(&self, accelerations: &[&[f64]], quantity: FitQuantity, last: usize) -> Vec<Vec<f64>> {
        let arch = Arch::new();
        let mut seen = Vec::with_capacity(accelerations.len());
        for chunk in accelerations.chunks(ABREAST) {
            // Places of a last chunk that nothing fills repeat its first.
            let accelerations = std::array::from_fn(|lane| *chunk.get(lane).unwrap_or(&chunk[0]));
            let lanes = arch.dispatch(Together { measurement: self, accelerations, quantity, last });
            seen.extend(lanes.into_iter().take(chunk.len()));
        }
        seen
    }

    #[inline(always)]
    fn seen_together<const N: usize>(
        &self,
        accelerations: [&[f64]; N],
        quantity: FitQuantity,
        v0_m_per_s: f64,
        last: usize,
    ) -> [Vec<f64>; N] {
        let (zero, count) = (self.contact_index(), self.reach(last));
        let gap = (self.time_s(zero) / self.dt_s).max(0.0);
        let instants = accelerations.iter().map(|a| a.len()).min().unwrap_or(0);
        let accelerations = accelerations.map(|a| &a[..instants]);
        let before = zero.min(count);
        let samples = before + instants.saturating_sub(1);
        let added = self.filter.map_or(0, |filter| filter.samples_added.min(samples.saturating_sub(1)));
        let mut waves: Vec<[f64; N]> = Vec::with_capacity(samples + 2 * added);
        // The record has the value after a jump at contact.
        waves.resize(added + samples, [0.0; N]);
        for (lane, a) in accelerations.iter().enumerate() {
            for (wave, pair) in waves[added + before..].iter_mut().zip(a.windows(2)) {
                wave[lane] = pair[0] + gap * (pair[1] - pair[0]);
            }
        }
        if let Some(filter) = &self.filter {
            filter.run(&mut waves, added);
        }
        let end = added + samples.min(last.min(self.samples.saturating_sub(1)) + 1);
        let seen = &mut waves[added..end];
        if matches!(quantity, FitQuantity::Velocity | FitQuantity::Displacement) {
            self.integrate(seen, quantity, v0_m_per_s, zero, gap);
        }
        std::array::from_fn(|lane| seen.iter().map(|values| values[lane]).collect())
    }

    /// Acceleration to velocity or displacement in its place, as the integrate stage has them: from the first sample,
    /// the displacement shifted to zero at contact; or from contact. Every lane by itself.
    #[inline(always)]
    fn integrate<const N: usize>(&self, waves: &mut [[f64; N]], quantity: FitQuantity, v0: f64, zero: usize, gap: f64) {
        let is_velocity = quantity == FitQuantity::Velocity;
        if self.from_contact || zero == 0 {
            let start: [(f64, f64); N] = std::array::from_fn(|lane| self.at_first_sample(waves, (zero, lane), v0, gap));
            let zero = zero.min(waves.len());
            waves[..zero].fill([if is_velocity { v0 } else { 0.0 }; N]);
            self.sum(&mut waves[zero..], is_velocity, (start.map(|s| s.0), start.map(|s| s.1)), 0);
            return;
        }
        let around = self.sum(waves, is_velocity, ([v0; N], [0.0; N]), zero);
        if zero < waves.len() && !is_velocity {
            let shift: [f64; N] = std::array::from_fn(|lane| {
                // The velocity taken as linear between the samples around contact.
                let (before, after) = (around.0[lane], around.1[lane]);
                let v_contact = after - (after - before) * gap;
                waves[zero][lane] - 0.5 * gap * self.dt_s * (after + v_contact)
            });
            waves.iter_mut().for_each(|x| x.iter_mut().zip(&shift).for_each(|(x, shift)| *x -= shift));
        }
    }

    /// Velocity and displacement at the first sample after contact, from there on.
    fn at_first_sample<const N: usize>(
        &self,
        a: &[[f64; N]],
        (zero, lane): (usize, usize),
        v0: f64,
        gap: f64,
    ) -> (f64, f64) {
        let dt = self.dt_s;
        if zero == 0 || gap <= 0.0 || zero >= a.len() {
            return (v0, v0 * gap * dt);
        }
        let at_zero = a[zero][lane] - (a[zero][lane] - a[zero - 1][lane]) * gap;
        match self.rule {
            IntegrationRule::Trapezoid | IntegrationRule::Exact => {
                let v = v0 + 0.5 * gap * dt * (at_zero + a[zero][lane]);
                (v, 0.5 * gap * dt * (v0 + v))
            }
            IntegrationRule::ForwardEuler => (v0 + gap * dt * at_zero, v0 * gap * dt),
        }
    }

    /// Sums; gives the velocities before and at sample `at`.
    #[inline(always)]
    fn sum<const N: usize>(
        &self,
        waves: &mut [[f64; N]],
        is_velocity: bool,
        (mut v, mut s): ([f64; N], [f64; N]),
        at: usize,
    ) -> ([f64; N], [f64; N]) {
        let dt = self.dt_s;
        let mut around = (v, v);
        for k in 0..waves.len() {
            let after = waves.get(k + 1).copied();
            let before = std::mem::replace(&mut waves[k], if is_velocity { v } else { s });
            if k + 1 == at {
                around.0 = v;
            } else if k == at {
                around.1 = v;
            }
            let Some(after) = after else { break };
            for lane in 0..N {
                match self.rule {
                    IntegrationRule::Trapezoid | IntegrationRule::Exact => {
                        let next = v[lane] + 0.5 * dt * (before[lane] + after[lane]);
                        s[lane] += 0.5 * dt * (v[lane] + next);
                        v[lane] = next;
                    }
                    IntegrationRule::ForwardEuler => {
                        s[lane] += dt * v[lane];
                        v[lane] += dt * before[lane];
                    }
                }
            }
        }
        around
    }
}

/// Several waves through one measurement, compiled for each width of the processor's vectors. Each lane is computed
/// by itself, in the same order: the result is the same to the last bit on every machine.
struct Together<'a> {
    measurement: &'a Measurement,
    accelerations: [&'a [f64]; ABREAST],
    quantity: FitQuantity,
    last: usize,
}

impl WithSimd for Together<'_> {
    type Output = [Vec<f64>; ABREAST];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.measurement.seen_together(self.accelerations, self.quantity, 0.0, self.last)
    }
}

impl TwoPassFilter {
    /// Samples after which a pass has forgotten its input: as many as its slowest pole takes to fall to
    /// [`FORGOTTEN`]. At least the two inputs that an output depends on; without limit where a pole does not decay.
    pub(crate) fn memory_samples(&self) -> usize {
        let [.., b1, b2] = self.coefficients;
        // Roots of z² - b1 z - b2.
        let square = b1 * b1 + 4.0 * b2;
        let largest = if square < 0.0 { (-b2).sqrt() } else { 0.5 * (b1.abs() + square.sqrt()) };
        if largest == 0.0 {
            return 2;
        }
        let samples = (FORGOTTEN.ln() / largest.ln()).ceil();
        if largest < 1.0 && samples.is_finite() { samples.max(2.0) as usize } else { usize::MAX }
    }

    /// What the filter makes of a wave of which nothing is cut off: as the filter stage.
    pub(crate) fn filtered(&self, wave: &[f64]) -> Vec<f64> {
        let added = self.samples_added.min(wave.len().saturating_sub(1));
        let mut waves: Vec<[f64; 1]> =
            std::iter::repeat_n(0.0, added).chain(wave.iter().copied()).map(|x| [x]).collect();
        self.run(&mut waves, added);
        waves[added..added + wave.len()].iter().map(|[x]| *x).collect()
    }

    /// Forward and backward over all but the first `added` waves, with the same extension and the same start of each
    /// pass as the filter stage; every lane by itself. The extension stands before and after them.
    #[inline(always)]
    pub(crate) fn run<const N: usize>(&self, waves: &mut Vec<[f64; N]>, added: usize) {
        let samples = waves.len() - added;
        if samples < 4 {
            return;
        }
        waves.resize(samples + 2 * added, [0.0; N]);
        let end = added + samples - 1;
        let (first, last) = (waves[added], waves[end]);
        for k in 1..=added {
            for lane in 0..N {
                waves[added - k][lane] = 2.0 * first[lane] - waves[added + k][lane];
                waves[end + k][lane] = 2.0 * last[lane] - waves[end - k][lane];
            }
        }
        let from_rest = added == 0;
        self.pass::<N, false>(waves, from_rest);
        self.pass::<N, true>(waves, from_rest);
    }

    /// One pass in place, from the end on if `BACKWARD`. Plain loops: closures would not be compiled for the vectors of
    /// the caller.
    #[inline(always)]
    fn pass<const N: usize, const BACKWARD: bool>(&self, waves: &mut [[f64; N]], from_rest: bool) {
        let [a0, a1, a2, b1, b2] = self.coefficients;
        let last = waves.len() - 1;
        let place = |k: usize| if BACKWARD { last - k } else { k };
        let mut start = [0.0; N];
        if !from_rest {
            let head = START_SAMPLES.min(waves.len());
            for k in 0..head {
                for (start, x) in start.iter_mut().zip(&waves[place(k)]) {
                    *start += x;
                }
            }
            start.iter_mut().for_each(|start| *start /= head as f64);
        }
        let (mut x2, mut x1) = (waves[place(0)], waves[place(1)]);
        let (mut y2, mut y1) = (start, start);
        waves[place(0)] = start;
        waves[place(1)] = start;
        for k in 2..waves.len() {
            let wave = &mut waves[place(k)];
            let x = *wave;
            for lane in 0..N {
                // The last output last: the next sample waits for it.
                wave[lane] = (a0 * x[lane] + a1 * x1[lane] + a2 * x2[lane] + b2 * y2[lane]) + b1 * y1[lane];
            }
            (x2, x1) = (x1, x);
            (y2, y1) = (y1, *wave);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn memory(poles: [f64; 2]) -> usize {
        let [p, q] = poles;
        TwoPassFilter { coefficients: [1.0, 0.0, 0.0, p + q, -p * q], samples_added: 0 }.memory_samples()
    }

    #[test]
    fn a_filter_forgets_as_its_slowest_pole_decays() {
        // ln 1e-10 / ln 0.9 = 218.5; the roots are exact to a rounding.
        assert_eq!([memory([0.9, 0.5]), memory([0.9, 0.0]), memory([-0.9, 0.5])], [219; 3]);
        assert_eq!(memory([0.0, 0.0]), 2);
        assert_eq!([memory([1.0, 0.5]), memory([1.2, 0.1]), memory([f64::NAN, 0.1])], [usize::MAX; 3]);
        // A complex pair of magnitude 0.9.
        let pair = TwoPassFilter { coefficients: [1.0, 0.0, 0.0, 1.2, -0.81], samples_added: 0 };
        assert_eq!(pair.memory_samples(), 219);
    }
}

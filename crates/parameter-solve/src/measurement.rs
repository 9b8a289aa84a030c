//! How a motion becomes the displacement in an artifact: sampling, channel filter, integration.

use crumple_lumped::{Instants, LumpedError, Model, Motion, Sensitivity};

use crate::FitQuantity;

/// A filter of second order that was run forward and backward, as the filter stage records it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoPassFilter {
    /// a0, a1, a2, b1, b2 of `y[i] = a0 x[i] + a1 x[i-1] + a2 x[i-2] + b1 y[i-1] + b2 y[i-2]`.
    pub coefficients: [f64; 5],
    /// Samples mirrored through the end points before filtering; 0: started from rest.
    pub samples_added: usize,
}

/// Rule of the integration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IntegrationRule {
    /// Trapezoids.
    Trapezoid,
    /// The first paper's: every sample holds until the next.
    ForwardEuler,
}

/// Everything between the vehicle and the displacement that a fit sees.
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
}

/// What a filter remembers is followed until it has fallen to this: 1e-10 of 1000 m/s² over its 10 ms moves no displacement by 1e-11 m.
const FORGOTTEN: f64 = 1e-10;
/// Samples of which the mean starts a pass, as in the filter stage.
const START_SAMPLES: usize = 10;
/// A sample this close to contact is at contact, in intervals: rounding of decimal time stamps.
const ON_GRID: f64 = 1e-6;

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

    /// The same for any mass (by its index from the barrier on; `None`: the compartment, also for an index beyond it) and quantity:
    /// the acceleration is what the filter makes of it, the velocity its first sum.
    pub fn motion(
        &self,
        model: &Model,
        mass: Option<usize>,
        quantity: FitQuantity,
        v0_m_per_s: f64,
        last: usize,
    ) -> Result<Vec<f64>, LumpedError> {
        let Some(samples) = self.samples_of_the_model(last) else {
            return Ok(self.seen(&[], quantity, v0_m_per_s, last));
        };
        let response = model.respond(v0_m_per_s, self.dt_s, samples)?;
        let motion = mass.and_then(|mass| response.motions.get(mass)).unwrap_or_else(|| response.compartment());
        Ok(self.seen(&motion.acceleration_m_per_s2, quantity, v0_m_per_s, last))
    }

    /// Derivatives of that by the parameters at these places of the model's names: a measurement is linear, so they are the
    /// derivatives of the acceleration measured without an impact speed.
    pub(crate) fn derivatives(
        &self,
        model: &Model,
        (mass, quantity): (Option<usize>, FitQuantity),
        v0_m_per_s: f64,
        last: usize,
        places: &[usize],
    ) -> Result<Vec<Vec<f64>>, LumpedError> {
        let Some(samples) = self.samples_of_the_model(last) else {
            return Ok(places.iter().map(|_| self.seen(&[], quantity, 0.0, last)).collect());
        };
        let at = Instants { first_s: 0.0, dt_s: self.dt_s, samples };
        let found = model.sensitivity(v0_m_per_s, &at, places)?;
        let motions =
            found.derivatives.iter().map(|motions| mass.and_then(|mass| motions.get(mass)).or(motions.last()));
        let accelerations: Vec<&[f64]> =
            motions.map(|motion| motion.map_or(&[][..], |motion| &motion.acceleration_m_per_s2)).collect();
        Ok(self.all_seen(&accelerations, quantity, last))
    }

    /// The same of a model that is no [`Model`]: `respond` gives the motion of every mass, and its derivatives by each free number if
    /// there are any. What is measured of the motion comes first, then of each derivative.
    pub(crate) fn of_motions(
        &self,
        (mass, quantity): (usize, FitQuantity),
        v0_m_per_s: f64,
        last: usize,
        respond: impl FnOnce(&Instants) -> Result<Sensitivity, LumpedError>,
    ) -> Result<Vec<Vec<f64>>, LumpedError> {
        let at = Instants { first_s: 0.0, dt_s: self.dt_s, samples: self.samples_of_the_model(last).unwrap_or(0) };
        let found = respond(&at)?;
        let of = |(motions, speed): (&Vec<Motion>, f64)| {
            let motion = motions.get(mass).map_or(&[][..], |motion| &motion.acceleration_m_per_s2);
            self.seen(motion, quantity, speed, last)
        };
        let derivatives = found.derivatives.iter().map(|motions| (motions, 0.0));
        Ok(std::iter::once((&found.motions, v0_m_per_s)).chain(derivatives).map(of).collect())
    }

    /// Samples of the acceleration that sample `last` of the record depends on.
    fn reach(&self, last: usize) -> usize {
        let memory = self.filter.as_ref().map_or(0, TwoPassFilter::memory_samples);
        last.min(self.samples.saturating_sub(1)).saturating_add(memory).saturating_add(1).min(self.samples)
    }

    /// Instants of the model from contact on that these samples lie between; `None` if all of them are before contact.
    fn samples_of_the_model(&self, last: usize) -> Option<usize> {
        self.reach(last).checked_sub(self.contact_index()).filter(|n| *n > 0).map(|n| n + 1)
    }

    /// What is recorded of an acceleration that is given at contact and whole intervals after it.
    fn seen(&self, acceleration: &[f64], quantity: FitQuantity, v0_m_per_s: f64, last: usize) -> Vec<f64> {
        let [seen] = self.seen_together([acceleration], quantity, v0_m_per_s, last);
        seen
    }

    /// The same of many of equal length, four at a time through the filter: its recursion waits for itself, not for the processor.
    fn all_seen(&self, accelerations: &[&[f64]], quantity: FitQuantity, last: usize) -> Vec<Vec<f64>> {
        let mut seen = Vec::with_capacity(accelerations.len());
        let mut four = accelerations.chunks_exact(4);
        for chunk in &mut four {
            seen.extend(self.seen_together([chunk[0], chunk[1], chunk[2], chunk[3]], quantity, 0.0, last));
        }
        seen.extend(four.remainder().iter().map(|a| self.seen(a, quantity, 0.0, last)));
        seen
    }

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
        let mut a = vec![[0.0; N]; zero.min(count)];
        // The record has the value after a jump at contact.
        a.extend((1..instants).map(|k| accelerations.map(|a| a[k - 1] + gap * (a[k] - a[k - 1]))));
        if let Some(filter) = &self.filter {
            a = filter.run(&a);
        }
        a.truncate(last.min(self.samples.saturating_sub(1)) + 1);
        std::array::from_fn(|lane| {
            let a: Vec<f64> = a.iter().map(|values| values[lane]).collect();
            match quantity {
                FitQuantity::Acceleration => a,
                FitQuantity::Velocity => self.integrate(&a, v0_m_per_s, zero, gap).0,
                FitQuantity::Displacement => self.integrate(&a, v0_m_per_s, zero, gap).1,
            }
        })
    }

    /// Velocity and displacement as the integrate stage has them: from the first sample, the displacement shifted to zero at
    /// contact; or from contact.
    fn integrate(&self, a: &[f64], v0: f64, zero: usize, gap: f64) -> (Vec<f64>, Vec<f64>) {
        let dt = self.dt_s;
        let mut x = vec![0.0; a.len()];
        let mut speeds = vec![v0; a.len()];
        let step = |v: &mut f64, x: &mut f64, before: f64, after: f64| match self.rule {
            IntegrationRule::Trapezoid => {
                let next = *v + 0.5 * dt * (before + after);
                *x += 0.5 * dt * (*v + next);
                *v = next;
            }
            IntegrationRule::ForwardEuler => {
                *x += dt * *v;
                *v += dt * before;
            }
        };
        if self.from_contact || zero == 0 {
            let (mut v, mut s) = (v0, v0 * gap * dt);
            if zero > 0 && gap > 0.0 && zero < a.len() {
                let at_zero = a[zero] - (a[zero] - a[zero - 1]) * gap;
                match self.rule {
                    IntegrationRule::Trapezoid => {
                        v = v0 + 0.5 * gap * dt * (at_zero + a[zero]);
                        s = 0.5 * gap * dt * (v0 + v);
                    }
                    IntegrationRule::ForwardEuler => v = v0 + gap * dt * at_zero,
                }
            }
            for k in zero..a.len() {
                (speeds[k], x[k]) = (v, s);
                if k + 1 < a.len() {
                    step(&mut v, &mut s, a[k], a[k + 1]);
                }
            }
            return (speeds, x);
        }
        let (mut v, mut s) = (v0, 0.0);
        let mut at_contact = (v0, v0);
        for k in 0..a.len() {
            (speeds[k], x[k]) = (v, s);
            if k + 1 == zero {
                at_contact.0 = v;
            } else if k == zero {
                at_contact.1 = v;
            }
            if k + 1 < a.len() {
                step(&mut v, &mut s, a[k], a[k + 1]);
            }
        }
        if zero < a.len() {
            // The velocity taken as linear between the samples around contact.
            let (before, after) = at_contact;
            let v_contact = after - (after - before) * gap;
            let shift = x[zero] - 0.5 * gap * dt * (after + v_contact);
            x.iter_mut().for_each(|x| *x -= shift);
        }
        (speeds, x)
    }
}

impl TwoPassFilter {
    /// Samples after which a pass has forgotten what it met: as many as its slowest pole takes to fall to [`FORGOTTEN`]; never
    /// fewer than the two inputs that an output depends on, without end where a pole does not decay.
    fn memory_samples(&self) -> usize {
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

    /// Forward and backward, with the same extension and the same start of each pass as the filter stage; every lane by itself.
    fn run<const N: usize>(&self, samples: &[[f64; N]]) -> Vec<[f64; N]> {
        let n = samples.len();
        if n < 4 {
            return samples.to_vec();
        }
        let added = self.samples_added.min(n - 1);
        let mirrored = |end: [f64; N], x: &[f64; N]| std::array::from_fn(|lane| 2.0 * end[lane] - x[lane]);
        let (first, last) = (samples[0], samples[n - 1]);
        let mut extended: Vec<[f64; N]> = Vec::with_capacity(n + 2 * added);
        extended.extend(samples[1..=added].iter().rev().map(|x| mirrored(first, x)));
        extended.extend_from_slice(samples);
        extended.extend(samples[n - 1 - added..n - 1].iter().rev().map(|x| mirrored(last, x)));
        let from_rest = added == 0;
        self.pass(&mut extended, from_rest);
        extended.reverse();
        self.pass(&mut extended, from_rest);
        extended.reverse();
        extended[added..added + n].to_vec()
    }

    fn pass<const N: usize>(&self, values: &mut [[f64; N]], from_rest: bool) {
        let [a0, a1, a2, b1, b2] = self.coefficients;
        let head = &values[..START_SAMPLES.min(values.len())];
        let mean = |lane: usize| head.iter().map(|x| x[lane]).sum::<f64>() / head.len() as f64;
        let start: [f64; N] = std::array::from_fn(|lane| if from_rest { 0.0 } else { mean(lane) });
        let (mut x2, mut x1) = (values[0], values[1]);
        let (mut y2, mut y1) = (start, start);
        values[0] = start;
        values[1] = start;
        for value in &mut values[2..] {
            let x = *value;
            // The last output last: the next sample waits for it.
            *value = std::array::from_fn(|lane| {
                (a0 * x[lane] + a1 * x1[lane] + a2 * x2[lane] + b2 * y2[lane]) + b1 * y1[lane]
            });
            (x2, x1) = (x1, x);
            (y2, y1) = (y1, *value);
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

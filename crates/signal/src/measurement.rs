//! How an acceleration becomes a wave of an artifact: sampling, channel filter, integration; the same done to the
//! acceleration of a model.
//!
//! All steps are linear, so the derivative of a measured motion by a parameter is the measurement of the derivative
//! of the acceleration, with no impact speed. Eight waves go through side by side: filter and sums are recursions
//! that wait for themselves. Where the steps are not known, the motion itself is compared.

use pulp::{Arch, Simd, WithSimd};

use crate::motion::{ContactGrid, ON_GRID};
use crate::{
    IntegrationRule, PreEventWindow, QuantityKind, Sampled, TwoPassFilter, UsedStart, pre_event, pre_event_within,
};

/// The stretch before the event from which the zero level of an acceleration was read, and the noise there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeforeEvent {
    /// First sample of the zero level, s after contact.
    pub from_s: f64,
    /// Samples that the zero level is the mean of.
    pub samples: usize,
    /// Standard deviation of the filtered acceleration, unit of the samples.
    pub noise: f64,
    /// Samples that it is of: those that the ends of the record do not reach through the filter.
    pub noise_samples: usize,
}

/// Noise over what the backward pass brings of the pulse, from which on the pulse is neglected: it then makes at most a
/// ninth of the variance, 5 % of the noise, which a window of 30 ms through CFC 60 knows to 25 %.
const CLEAR: f64 = 3.0;
/// How far the window of the noise moves away from contact at a time, s: a quarter of the 4.2 ms in which the response
/// of CFC 60 falls by ten.
const MOVED_S: f64 = 1e-3;
/// Rounding of a filter as a share of the largest sample, see [`TwoPassFilter`].
const ROUNDING: f64 = 1e-13;

impl BeforeEvent {
    /// In the usual window ([`PreEventWindow`]) of a filtered acceleration.
    ///
    /// A filter mirrors the record at its first sample and passes more noise there, so as many samples as it adds are
    /// left out of the noise. The window of the noise ends where the backward pass brings no pulse any more: where the
    /// noise up to there is three times as large as what it brings. `step` of a coarse sensor that
    /// no filter smooths ([`coarse_step`](crate::coarse_step)): its noise is at least that of rounding to steps,
    /// `step/√12`; Widrow & Kollár, *Quantization Noise*, 2008, 5.2. `None` where less than 10 ms are left: the record
    /// shows no noise, or nothing but the pulse.
    pub fn of(filtered: &Sampled, filter: Option<&TwoPassFilter>, step: Option<f64>) -> Option<Self> {
        let window = PreEventWindow::USUAL;
        let whole = pre_event(filtered)?;
        let end_s = filter.map_or(0.0, |filter| filter.samples_added as f64 * filtered.dt_s());
        let from_s = window.from_s.max(filtered.t0_s() + end_s);
        let first = filtered.index_at_or_after(from_s);
        let brought = brought_back(filtered, first, filtered.index_at_or_after(0.0), filter);
        let rounding = ROUNDING * filtered.samples().iter().fold(0.0, |largest: f64, a| largest.max(a.abs()));
        let of_steps = step.map_or(0.0, |step| step / 12.0_f64.sqrt());
        let mut to_s = window.to_s;
        loop {
            let inner = pre_event_within(filtered, PreEventWindow { from_s, to_s })?;
            let noise = inner.noise_floor.max(of_steps);
            let last = filtered.index_at_or_after(inner.to_s);
            // Behind contact everything is the pulse.
            let pulse = brought.get(last.saturating_sub(first)).copied().unwrap_or(f64::INFINITY);
            if noise > CLEAR * pulse.max(rounding) {
                return Some(Self {
                    from_s: whole.from_s,
                    samples: whole.samples,
                    noise,
                    noise_samples: inner.samples,
                });
            }
            to_s -= MOVED_S;
        }
    }
}

/// For each sample from `first` to the last but one before `contact`: the largest magnitude, there or earlier, of what
/// the backward pass of a filter brings of the pulse behind contact.
///
/// The forward pass brings nothing of the pulse to a sample before contact. There the backward pass has no input of
/// it, and runs down freely from its state at contact, the last two samples before it: `y[i] = b1·y[i+1] + b2·y[i+2]`,
/// as `e^(-√2·π·f·t)` for the design frequency f, by ten in 4.1 ms at CFC 60 (f = 125 Hz).
fn brought_back(filtered: &Sampled, first: usize, contact: usize, filter: Option<&TwoPassFilter>) -> Vec<f64> {
    let mut brought = filtered.samples().get(first..contact).map_or_else(Vec::new, <[f64]>::to_vec);
    let [.., b1, b2] = filter.map_or([0.0; 5], |filter| filter.coefficients);
    for i in (0..brought.len().saturating_sub(2)).rev() {
        brought[i] = b1 * brought[i + 1] + b2 * brought[i + 2];
    }
    let mut largest = 0.0_f64;
    for value in &mut brought {
        largest = largest.max(value.abs());
        *value = largest;
    }
    brought
}

/// Everything between the motion of the vehicle and a wave that a fit sees, as the records of a run state it.
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
    /// Its rule. `None`: no sum and no filter, the motion itself, as an exact instrument shows it. Stands for steps
    /// that are not known, or not made.
    pub rule: Option<IntegrationRule>,
    /// What the filtered acceleration shows before the event, m/s²; `None`: not known.
    pub before_event: Option<BeforeEvent>,
}

/// Waves that go through a measurement side by side.
pub const ABREAST: usize = 8;

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

    /// The same record of which the steps are not known: the motion itself is compared.
    #[must_use]
    pub fn exact(self) -> Self {
        Self { filter: None, rule: None, ..self }
    }

    /// Samples of a motion itself.
    pub fn of_samples(record: &Sampled) -> Self {
        Self {
            dt_s: record.dt_s(),
            first_s: record.t0_s(),
            samples: record.len(),
            filter: None,
            from_contact: true,
            rule: None,
            before_event: None,
        }
    }

    /// Whether the motion itself is compared.
    pub fn is_exact(&self) -> bool {
        self.rule.is_none()
    }

    /// Number of samples of the acceleration that sample `last` of the record depends on: the backward pass of a
    /// filter looks ahead.
    fn reach(&self, last: usize) -> usize {
        let memory = self.filter.as_ref().map_or(0, TwoPassFilter::memory_samples);
        last.min(self.samples.saturating_sub(1)).saturating_add(memory).saturating_add(1).min(self.samples)
    }

    /// Instants of a model, contact and whole intervals after it, that the samples up to `last` lie between; `None` if
    /// all of them are before contact.
    pub fn instants(&self, last: usize) -> Option<usize> {
        self.reach(last).checked_sub(self.contact_index()).filter(|n| *n > 0).map(|n| n + 1)
    }

    /// What is recorded of an acceleration, m/s², given at contact and at whole intervals after it: the quantity from
    /// the first sample of the record to sample `last`.
    ///
    /// The acceleration is what the filter makes of it, the velocity its first sum. Before the start of an integration
    /// from contact the displacement is zero and the velocity the impact speed. Between the instants the acceleration
    /// is taken as linear, which matters only where contact lies between two samples: an error of `dt² max|a''|/8`.
    pub fn record(&self, acceleration: &[f64], quantity: QuantityKind, v0_m_per_s: f64, last: usize) -> Vec<f64> {
        let [seen] = self.record_together([acceleration], quantity, v0_m_per_s, last);
        seen
    }

    /// The same of many of equal length without an impact speed, several at a time: filter and integration wait for
    /// themselves, not for the processor.
    pub fn record_all(&self, accelerations: &[&[f64]], quantity: QuantityKind, last: usize) -> Vec<Vec<f64>> {
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
    fn record_together<const N: usize>(
        &self,
        accelerations: [&[f64]; N],
        quantity: QuantityKind,
        v0: f64,
        last: usize,
    ) -> [Vec<f64>; N] {
        let (zero, count) = (self.contact_index(), self.reach(last));
        let gap_s = self.time_s(zero).max(0.0);
        let gap = gap_s / self.dt_s;
        let instants = accelerations.iter().map(|a| a.len()).min().unwrap_or(0);
        let before = zero.min(count);
        let samples = before + instants.saturating_sub(1);
        let mut waves = vec![[0.0; N]; samples];
        // The record has the value after a jump at contact.
        for (lane, a) in accelerations.iter().enumerate() {
            for (wave, pair) in waves[before..].iter_mut().zip(a[..instants].windows(2)) {
                wave[lane] = pair[0] + gap * (pair[1] - pair[0]);
            }
        }
        if let Some(filter) = &self.filter {
            filter.run(&mut waves, &|_| ());
        }
        waves.truncate(last.min(self.samples.saturating_sub(1)) + 1);
        if matches!(quantity, QuantityKind::Velocity | QuantityKind::Displacement) {
            let start = if self.from_contact { UsedStart::TimeZero } else { UsedStart::RecordStart };
            let rule = self.rule.unwrap_or_default();
            let (mut velocity, mut displacement) = (vec![[v0; N]; waves.len()], vec![[0.0; N]; waves.len()]);
            let from = if self.from_contact { zero.min(waves.len()) } else { 0 };
            let outputs = (&mut velocity[from..], &mut displacement[from..]);
            let grid = ContactGrid { dt_s: self.dt_s, zero, gap_s };
            grid.integrate(&waves, (rule, start), v0, outputs, |_| ());
            waves = if quantity == QuantityKind::Velocity { velocity } else { displacement };
        }
        std::array::from_fn(|lane| waves.iter().map(|values| values[lane]).collect())
    }
}

/// Several waves through one measurement, compiled for each width of the processor's vectors. Each lane is computed
/// by itself, in the same order: the result is the same to the last bit on every machine.
struct Together<'a> {
    measurement: &'a Measurement,
    accelerations: [&'a [f64]; ABREAST],
    quantity: QuantityKind,
    last: usize,
}

impl WithSimd for Together<'_> {
    type Output = [Vec<f64>; ABREAST];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.measurement.record_together(self.accelerations, self.quantity, 0.0, self.last)
    }
}

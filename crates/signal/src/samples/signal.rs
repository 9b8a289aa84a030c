//! Uniformly sampled signals.

use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Arc;

use crate::{Quantity, QuantityKind};

/// Why samples do not form a signal.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SignalError {
    /// The sampling interval is zero, negative or not finite.
    #[error("sampling interval {0} s is not a positive number")]
    Interval(f64),
    /// The time of the first sample is not finite.
    #[error("time of the first sample {0} s is not finite")]
    Start(f64),
    /// A sample is NaN or infinite.
    #[error("sample {index} (t = {time_s:.6} s) is {value}, a finite number is needed")]
    NotFinite {
        /// Index of the first such sample.
        index: usize,
        /// Its time.
        time_s: f64,
        /// NaN, inf or -inf.
        value: f64,
    },
    /// The samples measure something else.
    #[error("the samples are {found}, {needed} is needed")]
    Quantity {
        /// What they are.
        found: QuantityKind,
        /// What was asked for.
        needed: QuantityKind,
    },
}

/// Samples on a uniform time grid, whatever they measure: `t(k) = t0_s + k·dt_s`.
///
/// Always: `dt_s` is positive, `t0_s` and every sample are finite. The samples are shared: a clone or a
/// [`slice`](Self::slice) costs nothing, whatever the length of the record.
#[derive(Debug, Clone)]
pub struct Sampled {
    t0_s: f64,
    dt_s: f64,
    samples: Arc<Vec<f64>>,
    /// The part of the shared samples that is meant.
    part: Range<usize>,
}

/// Same grid and same samples.
impl PartialEq for Sampled {
    fn eq(&self, other: &Self) -> bool {
        self.t0_s == other.t0_s && self.dt_s == other.dt_s && self.samples() == other.samples()
    }
}

impl Sampled {
    /// Checks the grid and the samples and takes them. Errors: [`SignalError`].
    pub fn new(t0_s: f64, dt_s: f64, samples: Vec<f64>) -> Result<Self, SignalError> {
        if !(dt_s.is_finite() && dt_s > 0.0) {
            return Err(SignalError::Interval(dt_s));
        }
        if !t0_s.is_finite() {
            return Err(SignalError::Start(t0_s));
        }
        if let Some(index) = first_not_finite(&samples) {
            return Err(SignalError::NotFinite { index, time_s: t0_s + index as f64 * dt_s, value: samples[index] });
        }
        let part = 0..samples.len();
        Ok(Self { t0_s, dt_s, samples: Arc::new(samples), part })
    }

    /// The same samples on a time axis whose first sample is at `t0_s`, which must be finite.
    pub fn starting_at(&self, t0_s: f64) -> Result<Self, SignalError> {
        if !t0_s.is_finite() {
            return Err(SignalError::Start(t0_s));
        }
        Ok(Self { t0_s, ..self.clone() })
    }

    /// Time of sample 0, s.
    pub fn t0_s(&self) -> f64 {
        self.t0_s
    }

    /// Sampling interval, s.
    pub fn dt_s(&self) -> f64 {
        self.dt_s
    }

    /// Sampling rate, Hz.
    pub fn rate_hz(&self) -> f64 {
        1.0 / self.dt_s
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.part.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.part.is_empty()
    }

    /// The samples, SI.
    pub fn samples(&self) -> &[f64] {
        &self.samples[self.part.clone()]
    }

    /// The samples, taken out; copied if they are shared with another signal or part of a longer one.
    pub fn into_samples(self) -> Vec<f64> {
        let Self { samples, part, .. } = self;
        match Arc::try_unwrap(samples) {
            Ok(whole) if part.len() == whole.len() => whole,
            Ok(whole) => whole[part].to_vec(),
            Err(shared) => shared[part].to_vec(),
        }
    }

    /// Time of sample `index`, s. `index` may lie past the end.
    pub fn time_s(&self, index: usize) -> f64 {
        self.t0_s + index as f64 * self.dt_s
    }

    /// Time of the last sample, s; `t0_s` if there is none.
    pub fn end_s(&self) -> f64 {
        self.time_s(self.len().saturating_sub(1))
    }

    /// All sample times, s.
    pub fn times_s(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.len()).map(|k| self.time_s(k))
    }

    /// First index whose time is at or after `t_s`, with a slack of `1e-6·dt` for rounding; at most `len`.
    pub fn index_at_or_after(&self, t_s: f64) -> usize {
        let k = ((t_s - self.t0_s) / self.dt_s - 1e-6).ceil();
        if k <= 0.0 { 0 } else { (k as usize).min(self.len()) }
    }

    /// The part with indices `from..to` (clamped to the record), on the same grid. Nothing is copied.
    pub fn slice(&self, from: usize, to: usize) -> Self {
        let to = to.min(self.len());
        let from = from.min(to);
        Self {
            t0_s: self.time_s(from),
            dt_s: self.dt_s,
            samples: Arc::clone(&self.samples),
            part: self.part.start + from..self.part.start + to,
        }
    }

    /// Linear interpolation at `t_s`; `None` outside the record.
    pub fn at(&self, t_s: f64) -> Option<f64> {
        let x = (t_s - self.t0_s) / self.dt_s;
        if self.is_empty() || x < -1e-9 || x > self.len() as f64 - 1.0 + 1e-9 {
            return None;
        }
        let k = (x.max(0.0) as usize).min(self.len() - 1);
        let next = (k + 1).min(self.len() - 1);
        let w = (x - k as f64).clamp(0.0, 1.0);
        let samples = self.samples();
        Some(samples[k] + w * (samples[next] - samples[k]))
    }
}

/// Index of the first NaN or infinity. Whole blocks are checked at once, at the speed of memory.
fn first_not_finite(samples: &[f64]) -> Option<usize> {
    const BLOCK: usize = 1024;
    let bad = samples.chunks(BLOCK).position(|block| !block.iter().fold(true, |all, x| all & x.is_finite()))?;
    samples[bad * BLOCK..].iter().position(|x| !x.is_finite()).map(|k| bad * BLOCK + k)
}

/// Samples that know what they measure: `Signal<Acceleration>` is in m/s².
#[derive(Debug, Clone, PartialEq)]
pub struct Signal<Q> {
    sampled: Sampled,
    quantity: PhantomData<Q>,
}

impl<Q: Quantity> Signal<Q> {
    /// Checks the grid and the samples and takes them. Errors: [`SignalError`].
    pub fn new(t0_s: f64, dt_s: f64, samples: Vec<f64>) -> Result<Self, SignalError> {
        Sampled::new(t0_s, dt_s, samples).map(Self::from)
    }

    /// The untyped samples.
    pub fn into_sampled(self) -> Sampled {
        self.sampled
    }

    /// A signal of the same quantity on the same grid with other samples, which must be finite.
    pub fn with_samples(&self, samples: Vec<f64>) -> Result<Self, SignalError> {
        Self::new(self.t0_s(), self.dt_s(), samples)
    }
}

/// Declares that the samples measure `Q`; the caller has checked it.
impl<Q: Quantity> From<Sampled> for Signal<Q> {
    fn from(sampled: Sampled) -> Self {
        Self { sampled, quantity: PhantomData }
    }
}

impl<Q> std::ops::Deref for Signal<Q> {
    type Target = Sampled;

    fn deref(&self) -> &Sampled {
        &self.sampled
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Acceleration;

    #[test]
    fn refuses_a_nan_and_names_its_place() {
        let error = Signal::<Acceleration>::new(-0.1, 0.1, vec![0.0, 1.0, f64::NAN]).unwrap_err();
        assert_eq!(error.to_string(), "sample 2 (t = 0.100000 s) is NaN, a finite number is needed");
    }

    #[test]
    fn a_nan_late_in_a_long_record_is_found_where_it_is() {
        for bad in [0, 1023, 1024, 4999] {
            let mut samples = vec![1.0; 5000];
            samples[bad] = f64::INFINITY;
            let error = Sampled::new(0.0, 1.0, samples).unwrap_err();
            assert!(matches!(error, SignalError::NotFinite { index, .. } if index == bad), "{error:?}");
        }
    }

    #[test]
    fn a_slice_shares_its_samples_and_equals_a_record_of_its_own() {
        let whole = Sampled::new(0.0, 0.5, (0..8).map(f64::from).collect()).unwrap();
        let part = whole.slice(2, 6).slice(1, 99);
        assert_eq!(part, Sampled::new(1.5, 0.5, vec![3.0, 4.0, 5.0]).unwrap());
        assert!(std::ptr::eq(&raw const whole.samples()[3], &raw const part.samples()[0]));
        assert_eq!(part.clone().into_samples(), [3.0, 4.0, 5.0]);
        assert_eq!(part.starting_at(7.0).unwrap().t0_s(), 7.0);
        assert_eq!((part.at(2.0), part.at(1.0)), (Some(4.0), None));
    }

    #[test]
    fn finds_the_sample_at_time_zero_despite_rounding() {
        let s = Sampled::new(-0.02, 1e-4, vec![0.0; 2701]).unwrap();
        assert_eq!(s.index_at_or_after(0.0), 200);
        assert_eq!(s.index_at_or_after(-1.0), 0);
        assert_eq!(s.index_at_or_after(9.0), 2701);
    }

    #[test]
    fn interpolates_inside_and_not_outside() {
        let s = Sampled::new(0.0, 0.5, vec![0.0, 1.0, 3.0]).unwrap();
        assert_eq!(s.at(0.75), Some(2.0));
        assert_eq!(s.at(1.0), Some(3.0));
        assert_eq!(s.at(1.1), None);
    }
}

//! Uniformly sampled signals.

use std::marker::PhantomData;

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
/// Always: `dt_s` is positive, `t0_s` and every sample are finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    t0_s: f64,
    dt_s: f64,
    samples: Vec<f64>,
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
        if let Some(index) = samples.iter().position(|x| !x.is_finite()) {
            return Err(SignalError::NotFinite { index, time_s: t0_s + index as f64 * dt_s, value: samples[index] });
        }
        Ok(Self { t0_s, dt_s, samples })
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
        self.samples.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// The samples, SI.
    pub fn samples(&self) -> &[f64] {
        &self.samples
    }

    /// The samples, taken out.
    pub fn into_samples(self) -> Vec<f64> {
        self.samples
    }

    /// Time of sample `index`, s. `index` may lie past the end.
    pub fn time_s(&self, index: usize) -> f64 {
        self.t0_s + index as f64 * self.dt_s
    }

    /// Time of the last sample, s; `t0_s` if there is none.
    pub fn end_s(&self) -> f64 {
        self.time_s(self.samples.len().saturating_sub(1))
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

    /// The part with indices `from..to` (clamped to the record), on the same grid.
    pub fn slice(&self, from: usize, to: usize) -> Self {
        let to = to.min(self.len());
        let from = from.min(to);
        Self { t0_s: self.time_s(from), dt_s: self.dt_s, samples: self.samples[from..to].to_vec() }
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
        Some(self.samples[k] + w * (self.samples[next] - self.samples[k]))
    }
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

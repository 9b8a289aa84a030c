//! Windows of a record: the samples that a fit compares.
//!
//! Samples are picked, never interpolated: the response of a model is exact at any spacing, so leaving samples out
//! costs no accuracy of the comparison, only some of the averaging of noise.

use crumple_signal::Sampled;

use crate::SolveError;

/// Fewest samples of a record or wave that are compared.
pub(crate) const FEWEST: usize = 12;

/// Evenly spaced samples of a window of a record: every `stride`-th one, none interpolated.
///
/// Picking loses nothing here, since the model's response is exact at any spacing; it only leaves out samples.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Window {
    /// Time of the first sample after time zero, s.
    pub first_s: f64,
    /// Their spacing, s.
    pub dt_s: f64,
    /// The samples.
    pub samples: Vec<f64>,
}

impl Window {
    /// Picks at most `limit` samples from `from_s` to `to_s` after `time_zero_s`, all in s; `to_s` of `None` is the
    /// end of the record.
    ///
    /// Every sample within is as far from the next: the stride is the smallest whole number that keeps the limit.
    /// Errors: a window that is not inside the record (which may begin up to one interval after `from_s`), fewer than
    /// 12 samples.
    pub fn pick(
        record: &Sampled,
        time_zero_s: f64,
        from_s: f64,
        to_s: Option<f64>,
        limit: usize,
    ) -> Result<Self, SolveError> {
        let last_s = record.end_s() - time_zero_s;
        let to = to_s.unwrap_or(last_s);
        let slack = 1e-6 * record.dt_s();
        // A record may begin up to one interval after time zero.
        let late = record.t0_s() - time_zero_s > from_s + record.dt_s() + slack;
        let outside = from_s < 0.0 || from_s >= to || to > last_s + slack || late;
        if outside || !(from_s.is_finite() && to.is_finite()) {
            let first_s = (record.t0_s() - time_zero_s).max(0.0);
            return Err(SolveError::Window { from_s, to_s: to, first_s, last_s });
        }
        let first = record.index_at_or_after(time_zero_s + from_s);
        // One past the last index whose time is not after the end.
        let after = record.index_at_or_after(time_zero_s + to + 2.0 * slack).max(first);
        let count = after - first;
        if count < FEWEST {
            return Err(SolveError::TooFewSamples { samples: count, from_s, to_s: to, needed: FEWEST });
        }
        let stride = count.div_ceil(limit.max(FEWEST));
        let samples = record.samples()[first..after].iter().copied().step_by(stride).collect();
        let first_s = (record.time_s(first) - time_zero_s).max(0.0);
        Ok(Self { first_s, dt_s: record.dt_s() * stride as f64, samples })
    }

    /// Time of the last sample, s after time zero.
    pub fn last_s(&self) -> f64 {
        self.first_s + self.dt_s * (self.samples.len() - 1) as f64
    }

    /// The same window with at most `limit` samples.
    pub fn thinned(&self, limit: usize) -> Self {
        let stride = self.samples.len().div_ceil(limit);
        Self {
            first_s: self.first_s,
            dt_s: self.dt_s * stride as f64,
            samples: self.samples.iter().copied().step_by(stride).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record() -> Sampled {
        // The value is the time in ms.
        Sampled::new(-0.05, 1e-4, (0..2501).map(|k| f64::from(k) * 0.1 - 50.0).collect()).unwrap()
    }

    #[test]
    fn picks_samples_of_the_window_only() {
        let window = Window::pick(&record(), 0.0, 0.0, Some(0.075), 250).unwrap();
        // 751 samples, every fourth.
        assert_eq!((window.samples.len(), window.dt_s), (188, 4e-4));
        assert!(window.samples[0].abs() < 1e-9 && window.first_s.abs() < 1e-12);
        assert!((window.samples[187] - 74.8).abs() < 1e-9 && (window.last_s() - 0.0748).abs() < 1e-12);
    }

    #[test]
    fn refuses_a_window_outside_the_record() {
        let error = Window::pick(&record(), 0.0, 0.0, Some(0.3), 250).unwrap_err();
        assert!(matches!(error, SolveError::Window { last_s, .. } if (last_s - 0.2).abs() < 1e-12), "{error}");
        assert!(matches!(
            Window::pick(&record(), 0.0, 0.0, Some(0.001), 250),
            Err(SolveError::TooFewSamples { samples: 11, .. })
        ));
        assert!(Window::pick(&record(), 0.0, 0.02, Some(0.01), 250).is_err());
    }
}

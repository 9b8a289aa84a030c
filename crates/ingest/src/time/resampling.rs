//! Samples at uneven times on a uniform grid, by linear interpolation, where a person asks for it (`--resample`).
//!
//! Between two samples the signal is taken for a straight line: the error is up to h²/8 times the second derivative, h
//! the step. Frequencies near half the rate are damped; nothing is filtered.

/// Most samples that resampling may make.
const RESAMPLED_LIMIT: f64 = 1e8;

/// Largest distance of a stamp from the grid of its mean step, in steps.
pub fn jitter(times: &[f64]) -> f64 {
    let n = times.len();
    let dt = (times[n - 1] - times[0]) / (n - 1) as f64;
    times.iter().enumerate().map(|(k, t)| (t - times[0] - k as f64 * dt).abs() / dt).fold(0.0, f64::max)
}

/// Largest difference of a step from the median step, as a fraction of that.
pub fn step_jitter(times: &[f64], median_s: f64) -> f64 {
    times.windows(2).map(|pair| (pair[1] - pair[0] - median_s).abs() / median_s).fold(0.0, f64::max)
}

/// A rate in Hz near that of the steps, with three digits at most, to be typed.
pub fn rate_to_type(step_s: f64) -> f64 {
    let rate = 1.0 / step_s;
    let unit = 10_f64.powf((rate.log10().floor() - 2.0).max(0.0));
    ((rate / unit).round() * unit).max(1.0)
}

/// For each instant of a uniform grid from the first sample on: the sample before it, and the part of the way to the
/// next.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearInterpolation {
    positions: Vec<usize>,
    parts: Vec<f64>,
}

impl LinearInterpolation {
    /// Number of instants.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Values on the grid from `count` samples, up to the last instant they reach.
    pub fn apply(&self, count: usize, read: impl Fn(usize) -> f64) -> Vec<f64> {
        let inside = self.positions.iter().zip(&self.parts).take_while(|(k, _)| **k + 1 < count);
        inside.map(|(k, part)| read(*k) + part * (read(k + 1) - read(*k))).collect()
    }
}

/// The interpolation from `times`, which increase, at `rate_hz`; `None` if that gives no usable number of samples.
pub fn resample(times: &[f64], rate_hz: f64) -> Option<LinearInterpolation> {
    let span = times[times.len() - 1] - times[0];
    let count = (span * rate_hz + 1e-9).floor() + 1.0;
    if !(rate_hz > 0.0 && (2.0..=RESAMPLED_LIMIT).contains(&count)) {
        return None;
    }
    let (mut positions, mut parts) = (Vec::new(), Vec::new());
    let mut k = 0;
    for i in 0..count as usize {
        let t = times[0] + i as f64 / rate_hz;
        while k + 2 < times.len() && times[k + 1] <= t {
            k += 1;
        }
        positions.push(k);
        parts.push(((t - times[k]) / (times[k + 1] - times[k])).clamp(0.0, 1.0));
    }
    Some(LinearInterpolation { positions, parts })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resampling_is_linear_and_keeps_the_ends() {
        let times = [0.0, 0.9, 2.1, 3.0];
        let interpolation = resample(&times, 1.0).unwrap();
        // A straight line comes back exactly but for rounding.
        let line = interpolation.apply(4, |k| times[k]);
        assert!(line.iter().enumerate().all(|(k, t)| (t - k as f64).abs() < 1e-15), "{line:?}");
        assert_eq!((interpolation.len(), resample(&times, 0.0), resample(&times, 1e30)), (4, None, None));
        // A channel that ends early is not prolonged.
        assert_eq!(interpolation.apply(3, |k| times[k]).len(), 3);
    }

    #[test]
    fn the_jitter_is_that_of_steps_against_their_median() {
        let times = [0.0, 1.0, 2.0, 3.25, 4.0];
        assert_eq!(step_jitter(&times, 1.0), 0.25);
        assert_eq!((rate_to_type(1.0003e-4), rate_to_type(0.0499), rate_to_type(7.0)), (10_000.0, 20.0, 1.0));
    }
}

//! Samples at uneven times on a uniform grid, by linear interpolation, where a person asks for it (`--resample`).
//!
//! Between two samples the signal is taken for a straight line: the error is up to h²/8 times the second derivative, h
//! the step. Frequencies near half the rate are damped; nothing is filtered.

use crumple_signal::value::Frequency;

use crate::time::grid::{Grid, GridError, STEP_TOLERANCE, fit, median_step};
use crate::{IngestError, IngestSettings, Place, Result, refuse};

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

/// Stamps on a uniform grid.
#[derive(Debug)]
pub struct OnGrid {
    pub grid: Grid,
    /// How samples are brought to it; `None` where they lie on it.
    pub interpolation: Option<LinearInterpolation>,
    /// To which rate they are brought, and how uneven they were.
    pub words: String,
    /// It was not asked for: only a list takes such samples.
    pub lacks_a_rate: bool,
}

/// The grid of stamps, in s, at least two, that increase: as they are, or at the rate of `--resample`; for a list at
/// the median of uneven steps. `place` is that of a stamp. Errors: uneven ones, where no rate is asked for.
pub fn on_grid(
    times: &[f64],
    resolution_s: f64,
    settings: &IngestSettings,
    place: impl Fn(usize) -> Place,
) -> Result<OnGrid> {
    let median_s = median_step(times);
    let jitter_of_steps = || step_jitter(times, median_s);
    let advised = rate_to_type(median_s);
    let rate = match (settings.resample, fit(times, resolution_s)) {
        (Some(rate), _) => rate,
        (None, Ok(grid)) => {
            return Ok(OnGrid { grid, interpolation: None, words: String::new(), lacks_a_rate: false });
        }
        (None, Err(GridError::Uneven { .. })) if settings.listing => Frequency::from_si(1.0 / median_s),
        (None, Err(GridError::Uneven { index, step_s, dt_s })) => {
            let jitter = format!("jitter, max|dt - median|/median: {:.3}", jitter_of_steps());
            let found = format!("a step of {step_s:.9} s, where the median is {dt_s:.9} s ({jitter})");
            let expected = format!("equal steps within {STEP_TOLERANCE} of the interval");
            let hint = format!(
                "a gap is better exported again; for uneven sampling --resample {advised}Hz brings it to a uniform \
                 rate by linear interpolation"
            );
            return refuse(place(index), found, expected, hint);
        }
        (None, Err(GridError::Repeated { index } | GridError::Backwards { index })) => {
            return refuse(place(index), "a time that does not increase", "times that do", "sort them");
        }
    };
    let interpolation = resample(times, rate.si()).ok_or_else(|| {
        IngestError::content(
            place(0),
            format!("--resample {rate} gives no usable number of samples"),
            "a rate near that of the samples",
            format!("give --resample {advised}Hz"),
        )
    })?;
    let words = format!(
        "to {rate} by linear interpolation, as asked: {} samples (jitter {:.3}, max|dt - median|/median, median \
         {median_s:.6} s)",
        interpolation.len(),
        jitter_of_steps()
    );
    let grid = Grid { t0_s: times[0], dt_s: 1.0 / rate.si(), jitter: jitter(times) };
    Ok(OnGrid { grid, interpolation: Some(interpolation), words, lacks_a_rate: settings.resample.is_none() })
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

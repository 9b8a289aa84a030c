//! The rating of ISO/TS 18571: corridor, phase, magnitude and slope of two curves.

use crumple_signal::Sampled;

use crate::best_shift::{Correlation, best_shift, overlap};
use crate::cora::corridor_score;
use crate::metric::definitions::{ISO, ISO_CORRIDOR, ISO_MAGNITUDE, ISO_PHASE, ISO_SLOPE};
use crate::metric::value::rated_grid;
use crate::warping::Warping;
use crate::{Metric, MetricsError};

/// The constants of the rating.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Iso18571Options {
    /// Half width of the inner corridor over max|T|.
    pub inner_corridor: f64,
    /// Half width of the outer corridor over max|T|.
    pub outer_corridor: f64,
    /// Power between the corridors.
    pub corridor_power: f64,
    /// Largest shift over the length, and the shift that scores 0.
    pub largest_shift: f64,
    /// Power of the phase score.
    pub phase_power: f64,
    /// Error of magnitude that scores 0.
    pub largest_magnitude_error: f64,
    /// Power of the magnitude score.
    pub magnitude_power: f64,
    /// Half width of the band of time warping over the length.
    pub warping_window: f64,
    /// Error of slope that scores 0.
    pub largest_slope_error: f64,
    /// Power of the slope score.
    pub slope_power: f64,
    /// Weights of corridor, phase, magnitude and slope.
    pub weights: [f64; 4],
}

impl Default for Iso18571Options {
    fn default() -> Self {
        Self {
            inner_corridor: 0.05,
            outer_corridor: 0.5,
            corridor_power: 2.0,
            largest_shift: 0.2,
            phase_power: 1.0,
            largest_magnitude_error: 0.5,
            magnitude_power: 1.0,
            warping_window: 0.1,
            largest_slope_error: 2.0,
            slope_power: 1.0,
            weights: [0.4, 0.2, 0.2, 0.2],
        }
    }
}

/// Sliding scale of the rating.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grade {
    /// Above 0.94.
    Excellent,
    /// Above 0.80.
    Good,
    /// Above 0.58.
    Fair,
    /// The rest.
    Poor,
}

impl Grade {
    /// Of an overall rating.
    pub fn of(overall: f64) -> Self {
        match overall {
            r if r > 0.94 => Self::Excellent,
            r if r > 0.80 => Self::Good,
            r if r > 0.58 => Self::Fair,
            _ => Self::Poor,
        }
    }

    /// The word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Excellent => "excellent",
            Self::Good => "good",
            Self::Fair => "fair",
            Self::Poor => "poor",
        }
    }
}

/// The rating and its parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Iso18571 {
    /// Corridor score Z.
    pub corridor: f64,
    /// Phase score E_P.
    pub phase: f64,
    /// Magnitude score E_M; `None`: the warped reference is all zero.
    pub magnitude: Option<f64>,
    /// Slope score E_S; `None`: fewer than 9 samples after the shift, or a constant reference.
    pub slope: Option<f64>,
    /// Overall rating R; `None` where a part is missing.
    pub overall: Option<f64>,
    /// Its word.
    pub grade: Option<Grade>,
    /// Samples by which the comparison is late; negative: early.
    pub shift_samples: isize,
    /// Correlation at that shift.
    pub correlation: Option<f64>,
    /// Relative error of magnitude on the warping path.
    pub magnitude_error: Option<f64>,
    /// Relative error of slope.
    pub slope_error: Option<f64>,
    /// The rated interval, s on the signals' axis.
    pub interval_s: (f64, f64),
}

/// Rates how well a comparison (model) follows a reference (test): ISO/TS 18571:2014.
///
/// Both on one grid, cut to the interval that is to be rated; the standard wants 10 kHz, resampling is the caller's
/// step. Corridor on the signals as they are; phase from the shift (up to 20 % of the length) of largest Pearson
/// correlation; magnitude and slope on the shifted, cut signals, by dynamic time warping in a band of 10 % and by
/// smoothed derivatives. Equal curves rate 1. Unrounded. Memory of the warping: band times the root of the length.
/// Errors: grids that differ, no samples, a reference of zeros.
pub fn iso18571(
    reference: &Sampled,
    comparison: &Sampled,
    options: &Iso18571Options,
) -> Result<Iso18571, MetricsError> {
    rated_grid(reference, comparison)?;
    let (t, c) = (reference.samples(), comparison.samples());
    let n = t.len() as f64;
    let corridor = corridor_score(t, c, options.inner_corridor, options.outer_corridor, options.corridor_power);

    let limit = options.largest_shift * n;
    let shift = best_shift(t, c, limit.max(0.0) as usize, Correlation::Centred);
    let moved = shift.late.unsigned_abs() as f64;
    let phase = if moved == 0.0 { 1.0 } else { ((limit - moved) / limit).max(0.0).powf(options.phase_power) };

    let (t_cut, c_cut) = overlap(t, c, shift.late);
    let magnitude_error = magnitude_error(t_cut, c_cut, options.warping_window);
    let slope_error = slope_error(t_cut, c_cut, reference.dt_s());
    let score = |error: f64, largest: f64, power: f64| ((largest - error) / largest).max(0.0).powf(power);
    let magnitude = magnitude_error.map(|e| score(e, options.largest_magnitude_error, options.magnitude_power));
    let slope = slope_error.map(|e| score(e, options.largest_slope_error, options.slope_power));
    let overall = magnitude.zip(slope).map(|(magnitude, slope)| {
        let parts = [corridor, phase, magnitude, slope];
        options.weights.iter().zip(parts).map(|(weight, part)| weight * part).sum::<f64>()
    });
    Ok(Iso18571 {
        corridor,
        phase,
        magnitude,
        slope,
        overall,
        grade: overall.map(Grade::of),
        shift_samples: shift.late,
        correlation: shift.correlation,
        magnitude_error,
        slope_error,
        interval_s: (reference.t0_s(), reference.end_s()),
    })
}

impl Iso18571 {
    /// Corridor, phase, magnitude, slope and overall rating.
    pub fn metrics(&self) -> [Metric; 5] {
        let no_magnitude = "the reference is zero along the warping path";
        let no_slope = "fewer than 9 samples are left after the shift, or the reference is constant";
        let no_overall = if self.magnitude.is_none() { no_magnitude } else { no_slope };
        [
            Metric::with_value(&ISO_CORRIDOR, self.corridor),
            Metric::with_value(&ISO_PHASE, self.phase),
            Metric::of(&ISO_MAGNITUDE, self.magnitude, no_magnitude),
            Metric::of(&ISO_SLOPE, self.slope, no_slope),
            Metric::of(&ISO, self.overall, no_overall),
        ]
        .map(|metric| metric.over(self.interval_s.0, self.interval_s.1))
    }
}

/// Width of the running mean, samples.
const WIDTH: usize = 9;

/// `Σ|C' - T'|/Σ|T'|` of the smoothed derivatives; `None` below 9 samples or where T' is zero.
///
/// Central differences (one-sided at the ends), then a centred running mean of 9 points that shrinks to 7, 5, 3, 1 at
/// the ends.
fn slope_error(t: &[f64], c: &[f64], dt_s: f64) -> Option<f64> {
    if t.len() < WIDTH {
        return None;
    }
    let (t, c) = (smoothed(&derivative(t, dt_s)), smoothed(&derivative(c, dt_s)));
    let (mut gap, mut size) = (0.0, 0.0);
    for (t, c) in t.iter().zip(&c) {
        gap += (c - t).abs();
        size += t.abs();
    }
    let error = gap / size;
    error.is_finite().then_some(error)
}

/// Central differences, one-sided at both ends, unit of x per s.
fn derivative(x: &[f64], dt_s: f64) -> Vec<f64> {
    let n = x.len();
    let mut out = Vec::with_capacity(n);
    out.push((x[1] - x[0]) / dt_s);
    out.extend(x.windows(3).map(|w| (w[2] - w[0]) / (2.0 * dt_s)));
    out.push((x[n - 1] - x[n - 2]) / dt_s);
    out
}

/// Centred running mean over [`WIDTH`] samples, fewer near the ends.
fn smoothed(x: &[f64]) -> Vec<f64> {
    let n = x.len();
    let mean = |k: usize| {
        let half = (WIDTH / 2).min(k).min(n - 1 - k);
        x[k - half..=k + half].iter().sum::<f64>() / (2 * half + 1) as f64
    };
    (0..n).map(mean).collect()
}

/// `Σ|C - T|/Σ|T|` along the warping path; `None` where T is zero along it.
///
/// The path: least sum of `(C_i - T_j)²` with steps (i-1, j), (i, j-1), (i-1, j-1) from both starts to both ends, in
/// the band `|i - j| <= ceil(window·n) - 1`; the way back goes to the smallest accumulated neighbour, among equals in
/// that order.
fn magnitude_error(t: &[f64], c: &[f64], window: f64) -> Option<f64> {
    let n = t.len();
    if n == 0 {
        return None;
    }
    let band = ((window * n as f64).ceil() - 1.0).clamp(0.0, (n - 1) as f64) as usize;
    let (mut gap, mut size) = (0.0, 0.0);
    Warping::new(t, c, band).visit_path(|i, j| {
        gap += (c[i] - t[j]).abs();
        size += t[j].abs();
    });
    let error = gap / size;
    error.is_finite().then_some(error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grades_change_above_their_limits() {
        let words = [0.95, 0.94, 0.80, 0.58].map(|r| Grade::of(r).name());
        assert_eq!(words, ["excellent", "good", "fair", "poor"]);
    }

    #[test]
    fn a_reference_of_zeros_is_refused_and_a_short_one_has_no_slope() {
        let signal = |samples: Vec<f64>| Sampled::new(0.0, 1e-4, samples).unwrap();
        let (zeros, ones) = (signal(vec![0.0; 9]), signal(vec![1.0; 9]));
        let options = Iso18571Options::default();
        assert_eq!(
            iso18571(&zeros, &ones, &options).unwrap_err().to_string(),
            "the reference is zero everywhere, a rating needs a reference that is not"
        );
        let short = signal(vec![0.0, 1.0, 2.0, 1.0]);
        let rating = iso18571(&short, &short, &options).unwrap();
        assert_eq!((rating.corridor, rating.slope, rating.overall), (1.0, None, None));
        assert!(rating.metrics()[4].definition.starts_with("absent: fewer than 9 samples"));
    }

    #[test]
    fn a_ramp_keeps_its_slope_up_to_the_ends() {
        let ramp: Vec<f64> = (0..20).map(|k| f64::from(k) * 0.5).collect();
        assert!(smoothed(&derivative(&ramp, 0.25)).iter().all(|slope| *slope == 2.0));
        let steeper: Vec<f64> = ramp.iter().map(|x| 1.5 * x).collect();
        assert_eq!(slope_error(&ramp, &steeper, 0.25), Some(0.5));
        assert_eq!(slope_error(&[1.0; 20], &steeper, 0.25), None);
        assert_eq!(slope_error(&ramp[..8], &steeper[..8], 0.25), None);
    }
}

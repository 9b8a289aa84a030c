//! Corridors from several tests or from polylines, and how a signal lies in them.

use crumple_signal::Sampled;

use crate::metric::definitions::{CORRIDOR_EXCURSION, CORRIDOR_EXIT, CORRIDOR_INSIDE};
use crate::metric::grid::same_grid;
use crate::{Metric, MetricsError};

/// How wide a corridor of several tests is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorridorOptions {
    /// Half width in standard deviations: 1 or 2.
    pub sigmas: f64,
    /// Least half width over the largest |mean|.
    pub least_half_width: f64,
}

impl Default for CorridorOptions {
    fn default() -> Self {
        Self { sigmas: 1.0, least_half_width: 0.05 }
    }
}

/// A lower and an upper bound at the times of a grid; undefined outside it.
#[derive(Debug, Clone, PartialEq)]
pub struct Corridor {
    /// Lower bound.
    pub lower: Sampled,
    /// Upper bound.
    pub upper: Sampled,
    /// Mean of the tests; `None` for a corridor from polylines.
    pub mean: Option<Sampled>,
    /// Number of tests; 0 for a corridor from polylines.
    pub tests: usize,
}

impl Corridor {
    /// Mean ± standard deviations (divisor n - 1) of two or more tests at equal impact speed, aligned at time zero on
    /// one grid; nowhere narrower than 5 % of the largest |mean| to either side.
    pub fn of_tests(tests: &[&Sampled], options: CorridorOptions) -> Result<Self, MetricsError> {
        let [first, others @ ..] = tests else { return Err(MetricsError::TooFewTests { tests: 0 }) };
        if others.is_empty() {
            return Err(MetricsError::TooFewTests { tests: 1 });
        }
        for other in others {
            same_grid(("the first test", first), ("another test", other))?;
        }
        let n = tests.len() as f64;
        let at = |k: usize| tests.iter().map(move |test| test.samples()[k]);
        let mean: Vec<f64> = (0..first.len()).map(|k| at(k).sum::<f64>() / n).collect();
        let least = options.least_half_width * mean.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let half = |k: usize| {
            let variance = at(k).map(|x| (x - mean[k]) * (x - mean[k])).sum::<f64>() / (n - 1.0);
            (options.sigmas * variance.sqrt()).max(least)
        };
        let (lower, upper) = (0..mean.len()).map(|k| (mean[k] - half(k), mean[k] + half(k))).unzip();
        let signal = |samples| Sampled::new(first.t0_s(), first.dt_s(), samples);
        Ok(Self { lower: signal(lower)?, upper: signal(upper)?, mean: Some(signal(mean)?), tests: tests.len() })
    }

    /// Lower and upper polylines of `(time in s, value)`, linear between points, sampled at the grid times where both
    /// are defined. Errors: times that do not increase, a lower bound above the upper, no common time.
    pub fn of_polylines(
        lower: &[(f64, f64)],
        upper: &[(f64, f64)],
        t0_s: f64,
        dt_s: f64,
    ) -> Result<Self, MetricsError> {
        for line in [lower, upper] {
            let increasing = line.windows(2).all(|pair| pair[0].0 < pair[1].0);
            if line.is_empty() || !increasing || line.iter().any(|(t, x)| !(t.is_finite() && x.is_finite())) {
                return Err(MetricsError::Polyline);
            }
        }
        let from_s = lower[0].0.max(upper[0].0);
        let to_s = lower[lower.len() - 1].0.min(upper[upper.len() - 1].0);
        // 1e-6 of an interval of slack for decimal times, as on a signal's grid.
        let first = ((from_s - t0_s) / dt_s - 1e-6).ceil();
        let last = ((to_s - t0_s) / dt_s + 1e-6).floor();
        // A corridor longer than any record is a mistake in its times.
        if !(last >= first && last - first < 1e9) {
            return Err(MetricsError::Polyline);
        }
        let t0_s = t0_s + first * dt_s;
        let sampled = |line: &[(f64, f64)]| {
            let n = (last - first) as usize + 1;
            Sampled::new(t0_s, dt_s, (0..n).map(|k| interpolated(line, t0_s + k as f64 * dt_s)).collect())
        };
        let (lower, upper) = (sampled(lower)?, sampled(upper)?);
        if lower.samples().iter().zip(upper.samples()).any(|(low, high)| low > high) {
            return Err(MetricsError::Polyline);
        }
        Ok(Self { lower, upper, mean: None, tests: 0 })
    }

    /// How a signal lies in the corridor, over the grid times that both have. Errors: another interval or an offset
    /// grid.
    pub fn hold(&self, signal: &Sampled) -> Result<CorridorResult, MetricsError> {
        let dt = signal.dt_s();
        let offset = (signal.t0_s() - self.lower.t0_s()) / dt;
        // Grids must coincide to a part in 1e6 of an interval, over the whole record.
        if (dt - self.lower.dt_s()).abs() > 1e-6 * dt / signal.len().max(1) as f64
            || (offset - offset.round()).abs() > 1e-6
        {
            return same_grid(("the corridor", &self.lower), ("the signal", signal))
                .map(|()| CorridorResult::default());
        }
        // Sample k of the signal is sample k + offset of the corridor.
        let offset = offset.round();
        let from = (-offset).max(0.0) as usize;
        let to = ((self.lower.len() as f64 - offset).max(0.0) as usize).min(signal.len());
        let mut result = CorridorResult { samples: to.saturating_sub(from), ..CorridorResult::default() };
        let mut stay = Excursion::default();
        for k in from..to {
            let p = (k as f64 + offset) as usize;
            let (x, low, high) = (signal.samples()[k], self.lower.samples()[p], self.upper.samples()[p]);
            let beyond = (low - x).max(x - high).max(0.0);
            if beyond == 0.0 {
                result.inside += 1;
                stay = Excursion::default();
                continue;
            }
            result.first_exit_s.get_or_insert(signal.time_s(k));
            if stay.samples == 0 {
                stay.from_s = signal.time_s(k);
            }
            stay.samples += 1;
            stay.duration_s = stay.samples as f64 * dt;
            stay.area += beyond * dt;
            if result.longest.is_none_or(|longest| stay.samples > longest.samples) {
                result.longest = Some(stay);
            }
        }
        Ok(result)
    }
}

/// Linear between the points of a polyline; its end values beyond them.
fn interpolated(line: &[(f64, f64)], t: f64) -> f64 {
    let next = line.partition_point(|point| point.0 < t).clamp(1, line.len().max(2) - 1);
    let Some((&(t1, x1), &(t2, x2))) = line.get(next - 1).zip(line.get(next)) else { return line[0].1 };
    x1 + ((t - t1) / (t2 - t1)).clamp(0.0, 1.0) * (x2 - x1)
}

/// A stay outside the corridor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Excursion {
    /// Its first sample, s.
    pub from_s: f64,
    /// Samples outside times the interval, s.
    pub duration_s: f64,
    /// Distance to the corridor, summed over it, in the signal's unit times s.
    pub area: f64,
    samples: usize,
}

/// How a signal lies in a corridor.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CorridorResult {
    /// Samples that both have.
    pub samples: usize,
    /// Samples inside, bounds included.
    pub inside: usize,
    /// First sample outside, s.
    pub first_exit_s: Option<f64>,
    /// The longest stay outside, the earliest of equals.
    pub longest: Option<Excursion>,
}

impl CorridorResult {
    /// Share of time inside, longest excursion, first exit.
    pub fn metrics(&self) -> [Metric; 3] {
        let share = (self.samples > 0).then(|| self.inside as f64 / self.samples as f64);
        let none = if self.samples > 0 { "the signal never leaves the corridor" } else { "no common time" };
        let excursion = Metric::of(&CORRIDOR_EXCURSION, self.longest.map(|stay| stay.duration_s), none);
        let excursion = match self.longest {
            Some(stay) => excursion.over(stay.from_s, stay.from_s + stay.duration_s),
            None => excursion,
        };
        [
            Metric::of(&CORRIDOR_INSIDE, share, "no common time"),
            excursion,
            Metric::of(&CORRIDOR_EXIT, self.first_exit_s, none),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal(samples: &[f64]) -> Sampled {
        Sampled::new(0.0, 0.5, samples.to_vec()).unwrap()
    }

    #[test]
    fn two_tests_make_a_corridor_that_is_nowhere_too_narrow() {
        let corridor =
            Corridor::of_tests(&[&signal(&[0.0, 9.0, 20.0]), &signal(&[0.0, 11.0, 20.0])], CorridorOptions::default())
                .unwrap();
        assert_eq!((corridor.mean.unwrap().samples(), corridor.tests), (&[0.0, 10.0, 20.0][..], 2));
        // Divisor n - 1: sqrt(2); elsewhere 5 % of 20.
        let root = 2.0_f64.sqrt();
        assert_eq!(corridor.upper.samples(), [1.0, 10.0 + root, 21.0]);
        assert_eq!(corridor.lower.samples(), [-1.0, 10.0 - root, 19.0]);
    }

    #[test]
    fn one_test_is_no_corridor() {
        let one = signal(&[1.0]);
        assert_eq!(
            Corridor::of_tests(&[&one], CorridorOptions::default()).unwrap_err().to_string(),
            "a corridor of 1 tests, at least 2 are needed"
        );
    }

    #[test]
    fn exits_and_excursions_are_counted_where_the_corridor_is_defined() {
        let corridor = Corridor::of_polylines(&[(0.5, 0.0), (3.0, 0.0)], &[(0.0, 1.0), (3.0, 4.0)], 0.0, 0.5).unwrap();
        assert_eq!((corridor.lower.t0_s(), corridor.upper.samples()), (0.5, &[1.5, 2.0, 2.5, 3.0, 3.5, 4.0][..]));
        let result = corridor.hold(&signal(&[9.0, 1.0, 3.0, -1.0, 0.0, 9.0, 4.0, 9.0])).unwrap();
        assert_eq!((result.samples, result.inside, result.first_exit_s), (6, 3, Some(1.0)));
        let longest = result.longest.unwrap();
        assert_eq!((longest.from_s, longest.duration_s, longest.area), (1.0, 1.0, 1.0));
        let [share, excursion, exit] = result.metrics();
        assert_eq!((share.value, excursion.value, exit.value), (Some(0.5), Some(1.0), Some(1.0)));
        assert!(corridor.hold(&Sampled::new(0.1, 0.5, vec![0.0]).unwrap()).is_err());
    }
}

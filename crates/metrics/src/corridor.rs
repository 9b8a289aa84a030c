//! Corridors of curves, and ratings by them: CORA.

use crumple_signal::Sampled;

use crate::best_shift::{Correlation, best_shift, overlap};
use crate::metric::definitions::{
    CORA, CORA_AUTOMATIC, CORA_CORRIDOR, CORA_CORRIDOR_AUTOMATIC, CORA_CROSS, CORA_CROSS_AUTOMATIC, CORRIDOR_EXCURSION,
    CORRIDOR_EXIT, CORRIDOR_INSIDE,
};
use crate::metric::value::{rated_grid, same_grid};
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

/// Corridor score of ISO 18571 and CORA: per sample 1 inside `inner·max|T|`, 0 outside `outer·max|T|`, between them
/// `((δo - |T - C|)/(δo - δi))^k`; their mean. The signals are neither shifted nor scaled. `t` is not all zero.
pub(crate) fn corridor_score(t: &[f64], c: &[f64], inner: f64, outer: f64, power: f64) -> f64 {
    let norm = t.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    let (inside, outside) = (inner * norm, outer * norm);
    let score = |gap: f64| {
        if gap < inside {
            1.0
        } else if gap > outside {
            0.0
        } else if outside > inside {
            ((outside - gap) / (outside - inside)).powf(power)
        } else {
            1.0
        }
    };
    t.iter().zip(c).map(|(t, c)| score((t - c).abs())).sum::<f64>() / t.len() as f64
}

/// Which part of the signals is rated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CoraInterval {
    /// The whole of both signals: the caller has cut them to the interval meant.
    Stated,
    /// From the first sample of the reference at or above `start` of max|T| to the last at or above `end` of it, longer
    /// by `extension` of its length on either side, inside the record.
    ///
    /// The thresholds are those of the manual; how its program applies them, and a further shortening at the end (0.2
    /// of the peak), is not known and not done: mark U, under definition ids of its own.
    Automatic {
        /// Threshold at the start over max|T|: 0.03.
        start: f64,
        /// Threshold at the end: 0.075.
        end: f64,
        /// Extension over the length: 0.01.
        extension: f64,
    },
}

impl CoraInterval {
    /// The automatic interval with the constants of the manual.
    pub const AUTOMATIC: Self = Self::Automatic { start: 0.03, end: 0.075, extension: 0.01 };

    /// First sample and one past the last.
    fn samples_rated(self, reference: &[f64]) -> (usize, usize) {
        let Self::Automatic { start, end, extension } = self else { return (0, reference.len()) };
        let peak = reference.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
        let first = reference.iter().position(|t| t.abs() >= start * peak).unwrap_or(0);
        let last = reference.iter().rposition(|t| t.abs() >= end * peak).unwrap_or(reference.len() - 1).max(first);
        let more = (extension.max(0.0) * (last - first) as f64).min(reference.len() as f64) as usize;
        (first.saturating_sub(more), (last + more + 1).min(reference.len()))
    }
}

/// The constants of the rating, in the words of its manual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoraOptions {
    /// Inner corridor a0 over max|T|.
    pub a_0: f64,
    /// Outer corridor b0 over max|T|.
    pub b_0: f64,
    /// Power k of the corridor.
    pub k: f64,
    /// Shift over the interval up to which the phase scores 1.
    pub d_min: f64,
    /// Shift over the interval from which the phase scores 0.
    pub d_max: f64,
    /// Least overlap of the shifted signals.
    pub int_min: f64,
    /// Power of the progression.
    pub k_v: f64,
    /// Power of the size.
    pub k_g: f64,
    /// Power of the phase.
    pub k_p: f64,
    /// Weights of progression, size and phase.
    pub g_v: f64,
    /// See [`g_v`](Self::g_v).
    pub g_g: f64,
    /// See [`g_v`](Self::g_v).
    pub g_p: f64,
    /// Weight of the corridor method.
    pub g_1: f64,
    /// Weight of the cross-correlation method.
    pub g_2: f64,
    /// The rated interval.
    pub interval: CoraInterval,
}

impl Default for CoraOptions {
    fn default() -> Self {
        Self {
            a_0: 0.05,
            b_0: 0.5,
            k: 2.0,
            d_min: 0.01,
            d_max: 0.12,
            int_min: 0.8,
            k_v: 10.0,
            k_g: 1.0,
            k_p: 1.0,
            g_v: 0.5,
            g_g: 0.25,
            g_p: 0.25,
            g_1: 0.5,
            g_2: 0.5,
            interval: CoraInterval::Stated,
        }
    }
}

/// The rating and its parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Cora {
    /// Corridor score.
    pub corridor: f64,
    /// Progression `((K + 1)/2)^k_v`.
    pub progression: f64,
    /// Size: ratio of the smaller to the larger sum of squares.
    pub size: f64,
    /// Phase.
    pub phase: f64,
    /// Weighted sum of the three.
    pub cross_correlation: f64,
    /// Total.
    pub total: f64,
    /// Samples by which the comparison is late; negative: early.
    pub shift_samples: isize,
    /// Largest cross-correlation K.
    pub correlation: f64,
    /// The rated interval, s on the signals' axis.
    pub interval_s: (f64, f64),
    /// How the interval was chosen.
    pub interval: CoraInterval,
}

/// Rates how well a comparison follows a reference after CORA's published formulas.
///
/// Over the whole of both signals, on one grid, or over the automatic interval ([`CoraInterval`]). Cross-correlation
/// `K(m) = ΣXY/sqrt(ΣX²·ΣY²)` without removing means, over shifts that keep 80 % of the overlap. Not checked against
/// the reference program. Errors: grids that differ, no samples, a reference of zeros.
pub fn cora(reference: &Sampled, comparison: &Sampled, options: &CoraOptions) -> Result<Cora, MetricsError> {
    rated_grid(reference, comparison)?;
    let (from, to) = options.interval.samples_rated(reference.samples());
    let (t, c) = (&reference.samples()[from..to], &comparison.samples()[from..to]);
    let n = t.len();
    let corridor = corridor_score(t, c, options.a_0, options.b_0, options.k);

    // Rounding of 1 - 0.8 must not cost a sample.
    let longest = (n as f64 * (1.0 - options.int_min) + 1e-9).clamp(0.0, (n - 1) as f64) as usize;
    let shift = best_shift(t, c, longest, Correlation::Raw);
    let correlation = shift.correlation.unwrap_or(0.0);
    let (t_cut, c_cut) = overlap(t, c, shift.late);
    let squares = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let (tt, cc) = (squares(t_cut), squares(c_cut));
    let size = if tt.max(cc) > 0.0 { (tt.min(cc) / tt.max(cc)).powf(options.k_g) } else { 1.0 };
    let moved = shift.late.unsigned_abs() as f64 / (n as f64 - 1.0).max(1.0);
    let phase = ((options.d_max - moved) / (options.d_max - options.d_min)).clamp(0.0, 1.0).powf(options.k_p);
    // K = -1 .. 1, rounding aside.
    let progression = ((correlation + 1.0) / 2.0).clamp(0.0, 1.0).powf(options.k_v);
    let cross_correlation = options.g_v * progression + options.g_g * size + options.g_p * phase;
    Ok(Cora {
        corridor,
        progression,
        size,
        phase,
        cross_correlation,
        total: options.g_1 * corridor + options.g_2 * cross_correlation,
        shift_samples: shift.late,
        correlation,
        interval_s: (reference.time_s(from), reference.time_s(to - 1)),
        interval: options.interval,
    })
}

impl Cora {
    /// Corridor, cross-correlation and total.
    pub fn metrics(&self) -> [Metric; 3] {
        let [corridor, cross, total] = match self.interval {
            CoraInterval::Stated => [&CORA_CORRIDOR, &CORA_CROSS, &CORA],
            CoraInterval::Automatic { .. } => [&CORA_CORRIDOR_AUTOMATIC, &CORA_CROSS_AUTOMATIC, &CORA_AUTOMATIC],
        };
        [
            Metric::with_value(corridor, self.corridor),
            Metric::with_value(cross, self.cross_correlation),
            Metric::with_value(total, self.total),
        ]
        .map(|metric| metric.over(self.interval_s.0, self.interval_s.1))
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

    #[test]
    fn scores_inside_between_and_outside() {
        let t = [10.0; 4];
        // Gaps 0, 2.75, 5 and 6 of corridors 0.5 and 5: 1, a quarter, 0 and 0.
        assert_eq!(corridor_score(&t, &[10.0, 12.75, 15.0, 4.0], 0.05, 0.5, 2.0), (1.0 + 0.25) / 4.0);
    }

    #[test]
    fn a_comparison_of_zeros_has_neither_progression_nor_size() {
        let signal = |samples: Vec<f64>| Sampled::new(0.0, 1e-4, samples).unwrap();
        let rating = cora(&signal(vec![1.0; 9]), &signal(vec![0.0; 9]), &CoraOptions::default()).unwrap();
        assert_eq!((rating.corridor, rating.size, rating.correlation), (0.0, 0.0, 0.0));
        assert!(rating.total.is_finite());
    }

    #[test]
    fn the_automatic_interval_leaves_out_the_quiet_ends_and_says_so() {
        // Half a sine of 100 samples between 50 and 50 quiet ones: 0.03 of the peak is passed at sample 51, 0.075 last
        // at sample 147; 96 intervals, longer by 0.01 of them, which is no whole sample.
        let at = |k: i32| {
            if (50..150).contains(&k) { (f64::from(k - 50) * std::f64::consts::PI / 100.0).sin() } else { 0.0 }
        };
        let t = Sampled::new(0.0, 1e-3, (0..200).map(at).collect()).unwrap();
        let c = Sampled::new(0.0, 1e-3, (0..200).map(|k| 0.9 * at(k)).collect()).unwrap();
        let rated = |interval| cora(&t, &c, &CoraOptions { interval, ..CoraOptions::default() }).unwrap();
        let (whole, automatic) = (rated(CoraInterval::Stated), rated(CoraInterval::AUTOMATIC));
        assert!((automatic.interval_s.0 - 0.051).abs() < 1e-12 && (automatic.interval_s.1 - 0.147).abs() < 1e-12);
        assert_eq!(whole.interval_s.0, 0.0);
        // Quiet ends agree perfectly and flatter the corridor of the whole.
        assert!(automatic.corridor < whole.corridor);
        assert_eq!(automatic.metrics().map(|m| m.id)[2], "cora-automatic");
    }
}

//! Ratings of one curve by another: the corridor score of ISO 18571 and CORA, and CORA.

use crumple_signal::Sampled;

use crate::best_shift::{Correlation, best_shift, overlap};
use crate::metric::definitions::{
    CORA, CORA_AUTOMATIC, CORA_CORRIDOR, CORA_CORRIDOR_AUTOMATIC, CORA_CROSS, CORA_CROSS_AUTOMATIC,
};
use crate::metric::value::rated_grid;
use crate::{Metric, MetricsError};

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

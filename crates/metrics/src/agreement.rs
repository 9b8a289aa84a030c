//! How far two curves, or several channels, agree: residuals, and the spread of what is read off them.

use std::f64::consts::PI;

use crumple_signal::{Acceleration, Sampled, Signal, Velocity};

use crate::metric::definitions::{
    ANOVA_MEAN, ANOVA_STD, FIT, NRMSE, R2, RMSE, SPRAGUE_GEERS_C, SPRAGUE_GEERS_M, SPRAGUE_GEERS_P, THEIL_U1, THEIL_U2,
    VAF,
};
use crate::metric::value::same_grid;
use crate::{Interval, IntervalBy, Metric, MetricsError};

/// All measures of one pair of curves; `None` where a measure is not defined for them.
#[derive(Debug, Clone, PartialEq)]
pub struct Residuals {
    /// Root mean square of m - c, in the unit of the curves.
    pub rmse: f64,
    /// `100·(1 - ‖m - c‖/‖m - mean m‖)`, %; `None` for a constant m.
    pub fit_percent: Option<f64>,
    /// `‖m - c‖/‖m - mean m‖ = 1 - fit/100`.
    pub nrmse: Option<f64>,
    /// `1 - nrmse²`.
    pub r2: Option<f64>,
    /// Variance accounted for, `100·(1 - var(m - c)/var(m))`, %.
    pub vaf_percent: Option<f64>,
    /// Sprague-Geers magnitude `sqrt(I_cc/I_mm) - 1`; `None` for an m of zeros.
    pub sprague_geers_magnitude: Option<f64>,
    /// Sprague-Geers phase `acos(I_mc/sqrt(I_mm·I_cc))/π`; `None` for an m or c of zeros.
    pub sprague_geers_phase: Option<f64>,
    /// Root of the sum of their squares.
    pub sprague_geers_comprehensive: Option<f64>,
    /// Theil's inequality coefficient of 1958, 0..=1; `None` where both are zero.
    pub theil_u1: Option<f64>,
    /// Theil's of 1966, another number; `None` for an m of zeros.
    pub theil_u2: Option<f64>,
    /// Mean of (m - c)/max|m|; `None` for an m of zeros.
    pub anova_mean: Option<f64>,
    /// Standard deviation of the same, divisor N - 1; `None` for a single sample.
    pub anova_standard_deviation: Option<f64>,
    /// The compared interval, s on the signals' axis.
    pub interval_s: (f64, f64),
}

/// Compares a computed curve with the measured one on the same grid.
///
/// Sprague-Geers integrals by the trapezoid, the argument of the arc cosine clamped to ±1; near zero phase the arc
/// cosine keeps half the digits (2e-8). Sums are over samples for the rest. Errors: grids that differ, no samples.
pub fn residuals(measured: &Sampled, computed: &Sampled) -> Result<Residuals, MetricsError> {
    same_grid(("the measured curve", measured), ("the computed curve", computed))?;
    let (m, c) = (measured.samples(), computed.samples());
    let n = m.len() as f64;
    let largest = peak(m);
    let scale = scale(m, c);
    let pairs = || m.iter().zip(c).map(|(m, c)| (m / scale, c / scale));

    let mean_m = pairs().map(|(m, _)| m).sum::<f64>() / n;
    let mean_e = pairs().map(|(m, c)| m - c).sum::<f64>() / n;
    let (mut ee, mut var_m, mut var_e, mut mm, mut cc) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (m, c) in pairs() {
        let e = m - c;
        ee += e * e;
        var_m += (m - mean_m) * (m - mean_m);
        var_e += (e - mean_e) * (e - mean_e);
        mm += m * m;
        cc += c * c;
    }
    let constant = is_constant(m);
    let nrmse = finite((ee / var_m).sqrt()).filter(|_| !constant);

    let integral = |f: &dyn Fn(f64, f64) -> f64| {
        let ends = [0, m.len() - 1].map(|k| f(m[k] / scale, c[k] / scale));
        pairs().map(|(m, c)| f(m, c)).sum::<f64>() - (ends[0] + ends[1]) / 2.0
    };
    let (i_mm, i_cc, i_mc) = (integral(&|m, _| m * m), integral(&|_, c| c * c), integral(&|m, c| m * c));
    let magnitude = finite((i_cc / i_mm).sqrt() - 1.0);
    let phase = finite((i_mc / (i_mm * i_cc).sqrt()).clamp(-1.0, 1.0).acos() / PI);
    Ok(Residuals {
        rmse: scale * (ee / n).sqrt(),
        fit_percent: nrmse.map(|nrmse| 100.0 * (1.0 - nrmse)),
        nrmse,
        r2: nrmse.map(|nrmse| 1.0 - nrmse * nrmse),
        vaf_percent: finite(100.0 * (1.0 - var_e / var_m)).filter(|_| !constant),
        sprague_geers_magnitude: magnitude,
        sprague_geers_phase: phase,
        sprague_geers_comprehensive: magnitude.zip(phase).map(|(m, p)| m.hypot(p)),
        theil_u1: finite(ee.sqrt() / (mm.sqrt() + cc.sqrt())),
        theil_u2: finite((ee / mm).sqrt()),
        anova_mean: finite(mean_e * scale / largest),
        anova_standard_deviation: finite((var_e / (n - 1.0)).sqrt() * scale / largest),
        interval_s: (measured.t0_s(), measured.end_s()),
    })
}

/// Fit of a computed to a measured curve, `100·(1 - ‖m - c‖/‖m - mean m‖)`, %, as in [`residuals`]: 100 for equal
/// curves, 0 for one no better than the mean, negative for worse.
///
/// The simulation figure of MATLAB's `compare`. `None` for a constant m, for which it is undefined and not 100; without
/// samples, for unequal numbers of them, and where one is not finite.
pub fn fit_percent(measured: &[f64], computed: &[f64]) -> Option<f64> {
    let square_error = square_error(measured, computed)?;
    let scale = scale(measured, computed);
    let mean = measured.iter().map(|m| m / scale).sum::<f64>() / measured.len() as f64;
    let spread: f64 = measured.iter().map(|m| (m / scale - mean).powi(2)).sum();
    finite(100.0 * (1.0 - (square_error / spread).sqrt())).filter(|_| !is_constant(measured))
}

/// Root mean square of m - c, as in [`residuals`]; `None` as for [`fit_percent`], except that a constant m has one.
pub fn rmse(measured: &[f64], computed: &[f64]) -> Option<f64> {
    let square_error = square_error(measured, computed)?;
    finite(scale(measured, computed) * (square_error / measured.len() as f64).sqrt())
}

/// Sum of squares of m - c, both over their common scale.
fn square_error(m: &[f64], c: &[f64]) -> Option<f64> {
    if m.is_empty() || m.len() != c.len() {
        return None;
    }
    let scale = scale(m, c);
    finite(m.iter().zip(c).map(|(m, c)| (m / scale - c / scale).powi(2)).sum())
}

fn peak(x: &[f64]) -> f64 {
    x.iter().fold(0.0_f64, |m, x| m.max(x.abs()))
}

/// What both curves are divided by, so that squares of large samples do not overflow: every measure but rmse is free of
/// scale. A power of two, so that no digit of a sample changes; 1 for curves of zeros.
fn scale(m: &[f64], c: &[f64]) -> f64 {
    let largest = peak(m).max(peak(c));
    let exponent = largest.log2().floor().clamp(-1000.0, 1000.0);
    if largest > 0.0 && exponent.is_finite() { exponent.exp2() } else { 1.0 }
}

fn is_constant(m: &[f64]) -> bool {
    m.iter().all(|x| *x == m[0])
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

impl Residuals {
    /// One metric a measure; `unit` is that of the curves.
    pub fn metrics(&self, unit: &'static str) -> Vec<Metric> {
        let constant = "the measured curve is constant";
        let zero = "a curve is zero everywhere";
        let mut metrics = vec![Metric { unit, ..Metric::with_value(&RMSE, self.rmse) }];
        metrics.extend([
            Metric::of(&FIT, self.fit_percent, constant),
            Metric::of(&NRMSE, self.nrmse, constant),
            Metric::of(&R2, self.r2, constant),
            Metric::of(&VAF, self.vaf_percent, constant),
            Metric::of(&SPRAGUE_GEERS_M, self.sprague_geers_magnitude, zero),
            Metric::of(&SPRAGUE_GEERS_P, self.sprague_geers_phase, zero),
            Metric::of(&SPRAGUE_GEERS_C, self.sprague_geers_comprehensive, zero),
            Metric::of(&THEIL_U1, self.theil_u1, zero),
            Metric::of(&THEIL_U2, self.theil_u2, zero),
            Metric::of(&ANOVA_MEAN, self.anova_mean, zero),
            Metric::of(&ANOVA_STD, self.anova_standard_deviation, zero),
        ]);
        metrics.into_iter().map(|metric| metric.over(self.interval_s.0, self.interval_s.1)).collect()
    }
}

/// Dynamic crushes further apart than this share are not averaged.
pub const LARGEST_CRUSH_GAP: f64 = 0.05;

/// Acceleration, velocity and events of one of two redundant channels.
#[derive(Debug, Clone, Copy)]
pub struct ChannelMotion<'a> {
    /// Filtered acceleration.
    pub acceleration: &'a Signal<Acceleration>,
    /// Velocity.
    pub velocity: &'a Signal<Velocity>,
    /// Dynamic crush, m.
    pub dynamic_crush_m: Option<f64>,
}

/// How far two redundant channels (left and right) are apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// Largest |Δa|, m/s².
    pub largest_acceleration_gap_m_per_s2: f64,
    /// |Δv| at the given time; `None` outside the record.
    pub velocity_gap_m_per_s: Option<f64>,
    /// |ΔC|, m.
    pub crush_gap_m: Option<f64>,
    /// |ΔC| over the mean C.
    pub crush_gap_ratio: Option<f64>,
    /// Fit of the second to the first, %.
    pub fit_percent: Option<f64>,
}

impl Agreement {
    /// Whether the channels may be averaged: |ΔC|/C at most 5 %.
    pub fn may_be_averaged(&self) -> bool {
        self.crush_gap_ratio.is_some_and(|ratio| ratio <= LARGEST_CRUSH_GAP)
    }
}

/// Compares two channels on one grid after filtering; `at_s` is the time of the velocities, usually t_m, on their axis.
pub fn agreement(first: ChannelMotion<'_>, second: ChannelMotion<'_>, at_s: f64) -> Result<Agreement, MetricsError> {
    same_grid(("the first channel", first.acceleration), ("the second channel", second.acceleration))?;
    let pairs = first.acceleration.samples().iter().zip(second.acceleration.samples());
    let crush_gap_m = first.dynamic_crush_m.zip(second.dynamic_crush_m).map(|(a, b)| (a - b).abs());
    let mean = first.dynamic_crush_m.zip(second.dynamic_crush_m).map(|(a, b)| (a + b).abs() / 2.0);
    Ok(Agreement {
        largest_acceleration_gap_m_per_s2: pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max),
        velocity_gap_m_per_s: first.velocity.at(at_s).zip(second.velocity.at(at_s)).map(|(a, b)| (a - b).abs()),
        crush_gap_m,
        crush_gap_ratio: crush_gap_m.zip(mean).map(|(gap, mean)| gap / mean).filter(|ratio| ratio.is_finite()),
        fit_percent: residuals(first.acceleration, second.acceleration)?.fit_percent,
    })
}

/// A metric of one channel with the lowest and the highest of all channels as its interval.
///
/// The spread of redundant channels is the honest error bar of one of them; the value stays that of `of`, because
/// channels are averaged on request only. `None` without other channels, with different definitions, or where one has
/// no value.
pub fn over_channels(of: &Metric, others: &[&Metric]) -> Option<Metric> {
    let value = of.value.filter(|_| !others.is_empty())?;
    let (mut low, mut high) = (value, value);
    for other in others {
        let value = other.value.filter(|_| other.id == of.id && other.unit == of.unit)?;
        (low, high) = (low.min(value), high.max(value));
    }
    let by = IntervalBy::Channels(others.len() + 1);
    Some(Metric { interval: Some(Interval { low, high, by }), ..of.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::definitions::{OLC, VPI};

    fn of(m: &[f64], c: &[f64]) -> Residuals {
        residuals(&Sampled::new(0.0, 1.0, m.to_vec()).unwrap(), &Sampled::new(0.0, 1.0, c.to_vec()).unwrap()).unwrap()
    }

    #[test]
    fn a_scaled_curve_is_off_by_its_scale() {
        let r = of(&[0.0, 3.0, -3.0, 0.0], &[0.0, 1.5, -1.5, 0.0]);
        assert_eq!((r.sprague_geers_magnitude, r.sprague_geers_phase), (Some(-0.5), Some(0.0)));
        assert_eq!((r.fit_percent, r.nrmse, r.r2, r.vaf_percent), (Some(50.0), Some(0.5), Some(0.75), Some(75.0)));
        assert_eq!((r.theil_u2, r.anova_mean), (Some(0.5), Some(0.0)));
        // ‖e‖/(‖m‖ + ‖c‖) = 0.5/1.5.
        assert!((r.theil_u1.unwrap() - 1.0 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn an_offset_is_seen_by_fit_and_not_by_variance_accounted_for() {
        let r = of(&[1.0, 3.0, 1.0, 3.0], &[2.0, 4.0, 2.0, 4.0]);
        assert_eq!((r.fit_percent, r.vaf_percent, r.rmse), (Some(0.0), Some(100.0), 1.0));
    }

    #[test]
    fn what_is_not_defined_is_absent() {
        let r = of(&[0.0; 3], &[0.0; 3]);
        assert_eq!((r.fit_percent, r.theil_u1, r.sprague_geers_phase, r.anova_mean), (None, None, None, None));
        let metrics = r.metrics("m/s^2");
        assert_eq!((metrics[0].value, metrics[0].unit), (Some(0.0), "m/s^2"));
        assert_eq!(metrics[1].definition, "absent: the measured curve is constant");
        assert!(metrics.iter().all(|metric| metric.value.is_none_or(f64::is_finite)));
        // Squares of these overflow.
        assert_eq!(of(&[1e200, -1e200], &[1e200, -1e200]).fit_percent, Some(100.0));
    }

    #[test]
    fn fit_and_error_of_slices_are_those_of_the_residuals() {
        let (m, c) = ([0.25, 3.1, -3.3, 0.7], [0.2, 2.9, -3.0, 0.9]);
        let all = of(&m, &c);
        assert_eq!((fit_percent(&m, &c), rmse(&m, &c)), (all.fit_percent, Some(all.rmse)));
        let y = [1.0, 2.0, 6.0];
        assert_eq!((fit_percent(&y, &y), fit_percent(&y, &[3.0; 3])), (Some(100.0), Some(0.0)));
        assert!(fit_percent(&y, &[-9.0; 3]).unwrap() < 0.0);
        assert_eq!(rmse(&[0.0, 0.0], &[3.0, 4.0]), Some(12.5_f64.sqrt()));
    }

    #[test]
    fn fit_and_error_are_absent_where_they_are_not_defined() {
        assert_eq!((fit_percent(&[2.0; 3], &[2.0; 3]), rmse(&[2.0; 3], &[2.0; 3])), (None, Some(0.0)));
        assert_eq!((fit_percent(&[1.0, 2.0], &[1.0]), rmse(&[1.0], &[1.0, 2.0])), (None, None));
        assert_eq!((fit_percent(&[], &[]), rmse(&[], &[])), (None, None));
        let overflown = [1.0, f64::INFINITY];
        assert_eq!((fit_percent(&[1.0, 2.0], &overflown), rmse(&[1.0, 2.0], &overflown)), (None, None));
        assert_eq!((fit_percent(&overflown, &[1.0, 2.0]), rmse(&[1.0, f64::NAN], &[1.0, 2.0])), (None, None));
        // Squares of these leave the range of numbers, their ratio does not.
        assert_eq!(rmse(&[1e200, 0.0], &[1e200, 0.0]), Some(0.0));
    }

    #[test]
    fn the_spread_of_channels_is_the_interval_of_the_first() {
        let olc = |value| Metric::with_value(&OLC, value);
        let spread = over_channels(&olc(295.0), &[&olc(300.0), &olc(290.0)]).unwrap();
        let by = IntervalBy::Channels(3);
        assert_eq!((spread.value, spread.interval), (Some(295.0), Some(Interval { low: 290.0, high: 300.0, by })));
        assert_eq!(by.to_string(), "range over 3 channels");
        assert_eq!(over_channels(&olc(1.0), &[&Metric::absent(&OLC, "why")]), None);
        assert_eq!(over_channels(&olc(1.0), &[&Metric::with_value(&VPI, 1.0)]), None);
        assert_eq!(over_channels(&olc(1.0), &[]), None);
    }

    #[test]
    fn tells_how_far_two_channels_are_apart() {
        let a = [[0.0, -2.0, 0.0], [0.0, -3.0, 0.0]].map(|a| Signal::new(0.0, 0.5, a.to_vec()).unwrap());
        let v = [[4.0, 3.5, 3.0], [4.0, 3.25, 2.5]].map(|v| Signal::new(0.0, 0.5, v.to_vec()).unwrap());
        let motion = |k: usize, c| ChannelMotion { acceleration: &a[k], velocity: &v[k], dynamic_crush_m: c };
        let gaps = agreement(motion(0, Some(0.75)), motion(1, Some(0.73)), 0.75).unwrap();
        assert_eq!((gaps.largest_acceleration_gap_m_per_s2, gaps.velocity_gap_m_per_s), (1.0, Some(0.375)));
        assert!(gaps.may_be_averaged());
        assert!(!agreement(motion(0, Some(0.75)), motion(1, None), 0.75).unwrap().may_be_averaged());
        assert!(!agreement(motion(0, Some(0.75)), motion(1, Some(0.7)), 0.75).unwrap().may_be_averaged());
    }
}

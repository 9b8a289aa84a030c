//! Statistics of residuals and estimates: autocorrelation, covariance, information criteria, quantiles.
//!
//! Information criteria: how much better a model must fit to deserve its parameters.
//!
//! All of them weigh the mean square `V` of the residuals against the number `p` of free parameters for `N` samples;
//! for correlated residuals `N` is the number of independent ones. Only differences between models of the same data
//! count: 2 is weak evidence, 10 is strong (Burnham & Anderson 2002, section 2.6).
//!
//! Order statistics of small samples.
//!
//! Intervals of a bootstrap or a propagation are quantiles of its repetitions: with `n` of them a share `p` is
//! uncertain by about `sqrt(p (1 - p)/n)`.
//!
//! Tests of residuals: are they white, and are they independent of the input?
//!
//! A model that explains its data leaves residuals without memory (Box-Pierce) and without correlation with past
//! inputs. A failed test means that dynamics are missing; a passed one does not prove the model.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

use crate::linalg::dot;

pub use crate::estimation::statistics::autocorrelation::{
    Block, Covariance, SensorError, autocovariance, autoregressive_effective_samples, covariance, covariance_of_blocks,
    effective_samples, first_zero_lag, geyer_autocorrelation_time, lag_1_autocorrelation, sokal_autocorrelation_time,
};

mod autocorrelation;

/// Degrees of freedom above which Student's distribution is taken as the normal one: they differ by 2e-6 there.
const NORMAL_FROM: f64 = 1e6;

/// Half width of a 95 % interval in standard deviations of a normal distribution.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// The factor of a 95 % interval by Student's distribution; fewer than one degree of freedom count as one.
pub fn student_95(freedom: f64) -> f64 {
    let normal = || Normal::standard().inverse_cdf(0.975);
    if freedom >= NORMAL_FROM {
        return normal();
    }
    // A number of degrees that is none cannot be taken either.
    StudentsT::new(0.0, 1.0, freedom.max(1.0)).map_or_else(|_| normal(), |t| t.inverse_cdf(0.975))
}

/// 95 % point of chi-square with `n` degrees of freedom, positive; not a number otherwise.
pub fn chi_square_95(n: f64) -> f64 {
    ChiSquared::new(n).map_or(f64::NAN, |chi_square| chi_square.inverse_cdf(0.95))
}

/// The normal distribution function.
pub fn normal_distribution(z: f64) -> f64 {
    Normal::standard().cdf(z)
}

/// The value below which a share of a normal distribution lies, in standard deviations from its mean; infinite for a
/// share of 0 or 1.
pub fn normal_deviate(share: f64) -> f64 {
    Normal::standard().inverse_cdf(share)
}

/// The shortest interval that holds 95 % of a normal distribution and a value, as its two ends: below and above the
/// mean, in units of 1.96 deviations. `value`: how far it is above the mean, in the same unit.
pub fn shortest_with(value: f64) -> (f64, f64) {
    let normal = student_95(f64::INFINITY);
    if value.abs() <= 1.0 {
        return (1.0, 1.0);
    }
    let other = Normal::standard().inverse_cdf(0.95 + normal_distribution(-normal * value.abs())) / normal;
    if value < 0.0 { (-value, other) } else { (other, value) }
}

/// Criteria of one model; the smallest wins among models of the same data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InformationCriteria {
    /// Mean square of the residuals, `V`.
    pub loss: f64,
    /// Number of estimated parameters, `p`.
    pub parameters: usize,
    /// Number of samples, `N`: the effective number where residuals are correlated.
    pub samples: f64,
    /// `N ln V + 2 p` (Akaike 1974).
    pub aic: f64,
    /// AIC with the correction for short records, `+ 2 p (p + 1)/(N - p - 1)` (Hurvich & Tsai 1989); infinite when
    /// there are as many parameters as samples.
    pub aicc: f64,
    /// `N ln V + p ln N` (Schwarz 1978).
    pub bic: f64,
    /// Akaike's final prediction error, `V (1 + p/N)/(1 - p/N)`; infinite as above.
    pub fpe: f64,
    /// Minimum description length, `V (1 + p ln N / N)` (Rissanen 1978).
    pub mdl: f64,
}

impl InformationCriteria {
    /// Of a loss of `V > 0`, `samples` and a number of parameters. A loss of zero counts as the smallest number.
    pub fn new(loss: f64, samples: f64, parameters: usize) -> Self {
        let (n, p) = (samples.max(1.0), parameters as f64);
        let log = n * loss.max(f64::MIN_POSITIVE).ln();
        let aic = log + 2.0 * p;
        Self {
            loss,
            parameters,
            samples: n,
            aic,
            aicc: if n > p + 1.0 { aic + 2.0 * p * (p + 1.0) / (n - p - 1.0) } else { f64::INFINITY },
            bic: log + p * n.ln(),
            fpe: if n > p { loss * (1.0 + p / n) / (1.0 - p / n) } else { f64::INFINITY },
            mdl: loss * (1.0 + p * n.ln() / n),
        }
    }
}

/// The value below which a share of the sorted values lies, linear between order statistics (type 7 of Hyndman & Fan,
/// 1996); `None` without values. A share beyond 0 and 1 is taken for these.
pub fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let at = share.clamp(0.0, 1.0) * last as f64;
    let below = (at.floor() as usize).min(last);
    let above = (below + 1).min(last);
    Some(sorted[below] + (at - below as f64) * (sorted[above] - sorted[below]))
}

/// Whiteness of residuals and their independence of the input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResidualTests {
    /// Autocorrelation at lag 1: near 1 for a smooth error, as on oversampled records.
    pub lag_one: f64,
    /// Box-Pierce statistic `N sum r_k²` over the lags.
    pub whiteness: f64,
    /// Its 95 % point: white residuals stay below it nineteen times of twenty.
    pub whiteness_limit: f64,
    /// Largest `|correlation|` with the input, now or earlier, in units of its 95 % limit `1.96/sqrt N`; `None` without
    /// an input.
    pub input_correlation: Option<f64>,
    /// Number of lags.
    pub lags: usize,
}

/// Tests residuals at lags 1 to `lags` (input: 0 to `lags`). `None` for silent or too short residuals.
///
/// Box & Pierce, J. Am. Stat. Assoc. 65, 1970; Ljung, *System Identification*, 2nd ed., ch. 16.6.
pub fn residual_tests(residual: &[f64], input: Option<&[f64]>, lags: usize) -> Option<ResidualTests> {
    let n = residual.len();
    let energy = dot(residual, residual);
    if lags == 0 || n <= lags || !(energy > 0.0 && energy.is_finite()) {
        return None;
    }
    let autocorrelation = |lag: usize| dot(&residual[lag..], &residual[..n - lag]) / energy;
    let whiteness = n as f64 * (1..=lags).map(|lag| autocorrelation(lag).powi(2)).sum::<f64>();
    let input_correlation = input.filter(|u| u.len() == n).map(|u| {
        let norm = (energy * dot(u, u)).sqrt();
        let limit = NORMAL_95 / (n as f64).sqrt();
        (0..=lags)
            .map(|lag| if norm > 0.0 { (dot(&residual[lag..], &u[..n - lag]) / norm).abs() / limit } else { 0.0 })
            .fold(0.0, f64::max)
    });
    Some(ResidualTests {
        lag_one: autocorrelation(1),
        whiteness,
        whiteness_limit: chi_square_95(lags as f64),
        input_correlation,
        lags,
    })
}

/// Standard deviation about the mean, with `n - 1`; `None` for fewer than two values.
pub fn standard_deviation(values: &[f64]) -> Option<f64> {
    let n = values.len() as f64;
    if values.len() < 2 {
        return None;
    }
    let mean = values.iter().sum::<f64>() / n;
    Some((values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crate::estimation::random::uniform_at;

    #[test]
    fn points_are_those_of_the_tables() {
        // To the last printed digit: Abramowitz & Stegun, tables 26.10, 26.8, 26.1.
        for (freedom, wanted) in [(1.0, 12.706), (2.0, 4.303), (6.0, 2.447), (20.0, 2.086), (60.0, 2.000), (1e9, 1.960)]
        {
            assert!((student_95(freedom) - wanted).abs() < 5e-4, "{freedom}: {}", student_95(freedom));
        }
        assert_eq!(student_95(0.3), student_95(1.0));
        assert!((student_95(f64::INFINITY) - 1.959_964).abs() < 5e-7);
        for (n, wanted) in [(1.0, 3.841_46), (2.0, 5.991_46), (10.0, 18.307_0), (50.0, 67.504_8)] {
            assert!((chi_square_95(n) - wanted).abs() < 1e-4, "{n}: {}", chi_square_95(n));
        }
        assert!((normal_distribution(1.0) - 0.841_344_746).abs() < 1e-9 && normal_distribution(0.0) == 0.5);
    }

    #[test]
    fn an_interval_with_a_value_far_from_the_mean_still_holds_95_percent() {
        let normal = student_95(f64::INFINITY);
        // As it is where the value is inside, one-sided where that is far.
        assert_eq!(shortest_with(0.7), (1.0, 1.0));
        let (below, above) = shortest_with(-3.0);
        assert!(below == 3.0 && (above - 1.644_854 / normal).abs() < 1e-6, "{above}");
        let (below, above) = shortest_with(1.2);
        let held = normal_distribution(normal * above) - normal_distribution(-normal * below);
        assert!(above == 1.2 && (held - 0.95).abs() < 1e-9, "{below} {above}");
    }

    #[test]
    fn values_by_hand() {
        let c = InformationCriteria::new(1.0, 100.0, 3);
        assert_eq!((c.aic, c.bic), (6.0, 3.0 * 100.0_f64.ln()));
        assert!((c.aicc - (6.0 + 24.0 / 96.0)).abs() < 1e-12 && (c.fpe - 1.03 / 0.97).abs() < 1e-12);
        assert!(InformationCriteria::new(1.0, 3.0, 5).aicc.is_infinite());
    }

    #[test]
    fn values_by_hand_of_quantile() {
        assert_eq!(quantile(&[1.0, 2.0, 4.0], 0.5), Some(2.0));
        assert_eq!(quantile(&[1.0, 2.0, 4.0], 0.75), Some(3.0));
        assert_eq!(quantile(&[1.0, 2.0, 4.0], 7.0), Some(4.0));
        assert_eq!((quantile(&[], 0.5), quantile(&[3.0], 0.05)), (None, Some(3.0)));
    }

    #[test]
    fn white_noise_passes_and_a_smooth_error_fails() {
        let white: Vec<f64> = (0..2000).map(|k| uniform_at(7, k) - 0.5).collect();
        let input: Vec<f64> = (0..2000).map(|k| uniform_at(8, k) - 0.5).collect();
        let tests = residual_tests(&white, Some(&input), 20).unwrap();
        assert!(tests.whiteness < tests.whiteness_limit && tests.lag_one.abs() < 0.05, "{tests:?}");
        // 21 lags: the largest of as many normal numbers is seldom above 3.4 deviations.
        assert!(tests.input_correlation.unwrap() < 1.75, "{tests:?}");
        assert!(autoregressive_effective_samples(&white) > 1800.0);
        let smooth: Vec<f64> = (0..2000).map(|k| (f64::from(k) * 0.01).sin()).collect();
        assert!(residual_tests(&smooth, None, 20).unwrap().whiteness > 1e4);
        assert!(autoregressive_effective_samples(&smooth) < 10.0);
        assert_eq!(residual_tests(&[0.0; 50], None, 20), None);
    }

    #[test]
    fn chi_square_point_of_the_tables() {
        // 31.410 and 9.488.
        assert!((chi_square_95(20.0) - 31.41).abs() < 0.05 && (chi_square_95(4.0) - 9.488).abs() < 0.05);
    }

    #[test]
    fn values_by_hand_of_standard_deviation() {
        assert_eq!(standard_deviation(&[1.0, 3.0]), Some(2.0_f64.sqrt()));
        assert_eq!(standard_deviation(&[1.0]), None);
    }
}

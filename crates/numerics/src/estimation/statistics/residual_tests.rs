//! Tests of residuals: are they white, and are they independent of the input?
//!
//! A model that explains its data leaves residuals without memory (Box-Pierce) and without correlation with past
//! inputs. A failed test means that dynamics are missing; a passed one does not prove the model.

use crate::linalg::dot;

use super::distributions::chi_square_95;

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
        let limit = 1.96 / (n as f64).sqrt();
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crate::estimation::random::uniform_at;
    use crate::estimation::statistics::autoregressive_effective_samples;

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
}

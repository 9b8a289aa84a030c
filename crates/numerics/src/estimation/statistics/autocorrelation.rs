//! Autocorrelation of residuals in time, and how many independent samples it leaves.
//!
//! Three rules for three uses, each named by where it stops the sum `1 + 2 sum r_k`. Of a lumped model's misfit, slow
//! and not like any simple noise: all lags before the first that is not positive ([`geyer_autocorrelation_time`]). Of
//! noise that is drawn again in blocks: a window of five times the sum ([`sokal_autocorrelation_time`]). Criteria of
//! linear models count `N (1 - r)/(1 + r)` with the lag-1 autocorrelation, right for a first-order autoregression
//! ([`autoregressive_effective_samples`]).

use crate::linalg::{dot, real_transform};

/// Lag-1 autocorrelation of residuals, within 0 and 0.999 999; 0 for residuals that do not vary.
///
/// White residuals give about 0; the smooth misfit of a model to a crash gives nearly 1.
pub fn lag_1_autocorrelation(residuals: &[f64]) -> f64 {
    let mean = residuals.iter().sum::<f64>() / residuals.len().max(1) as f64;
    let power: f64 = residuals.iter().map(|r| (r - mean).powi(2)).sum();
    if power == 0.0 || !power.is_finite() {
        return 0.0;
    }
    let product: f64 = residuals.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum();
    (product / power).clamp(0.0, 0.999_999)
}

/// Autocovariance of residuals about zero at lags 0 .. `lags`, each divided by their number (so that any triangular
/// window of it is positive semidefinite).
pub fn autocovariance(residuals: &[f64], lags: usize) -> Vec<f64> {
    let n = residuals.len().max(1) as f64;
    (0..lags.min(residuals.len())).map(|lag| at_lag(residuals, lag) / n).collect()
}

/// `sum r[k] r[k + lag]`.
fn at_lag(residuals: &[f64], lag: usize) -> f64 {
    residuals[lag..].iter().zip(residuals).map(|(a, b)| a * b).sum()
}

/// First lag at which the autocovariance is not positive; at least 1.
pub fn first_zero_lag(covariance: &[f64]) -> usize {
    covariance.iter().skip(1).position(|c| *c <= 0.0).map_or(covariance.len(), |k| k + 1).max(1)
}

/// Autocorrelation time in samples: `1 + 2 sum r_k` over the lags before the first that is not positive; at least 1,
/// and 1 for residuals that are all zero.
///
/// Time: lags up to that one times the samples; above 20,000 samples all lags by two Fourier transforms.
///
/// Geyer's initial positive sequence ("Practical Markov chain Monte Carlo", Statistical Science 7(4), 1992), about zero
/// and not about the mean: a constant misfit is one sample. A slow swing of `m` periods in the window counts as about
/// `3 m` samples.
pub fn geyer_autocorrelation_time(residuals: &[f64]) -> f64 {
    let power = at_lag(residuals, 0);
    if power <= 0.0 || !power.is_finite() {
        return 1.0;
    }
    let sum: f64 = if residuals.len() > DIRECT_UP_TO {
        all_lags(residuals).into_iter().skip(1).take_while(|product| *product > 0.0).sum()
    } else {
        (1..residuals.len()).map(|lag| at_lag(residuals, lag)).take_while(|product| *product > 0.0).sum()
    };
    (1.0 + 2.0 * sum / power).max(1.0)
}

/// Residuals up to which lags are summed one by one: a tenth of a second for residuals of one sign.
const DIRECT_UP_TO: usize = 20_000;

/// `sum r[k] r[k + lag]` for all lags: the inverse transform of the power spectrum, with as many zeros as samples
/// behind the residuals so that nothing comes around. Rounding: some 1e-16 of the power.
fn all_lags(residuals: &[f64]) -> Vec<f64> {
    let length = (2 * residuals.len()).next_power_of_two();
    let plan = real_transform(length);
    let (forward, inverse) = (plan.forward, plan.inverse);
    let mut padded = residuals.to_vec();
    padded.resize(length, 0.0);
    let mut spectrum = forward.make_output_vec();
    if forward.process(&mut padded, &mut spectrum).is_err() {
        return Vec::new();
    }
    for value in &mut spectrum {
        *value = value.norm_sqr().into();
    }
    if inverse.process(&mut spectrum, &mut padded).is_err() {
        return Vec::new();
    }
    padded.truncate(residuals.len());
    padded.iter_mut().for_each(|value| *value /= length as f64);
    padded
}

/// Independent samples that residuals are worth: their number over [`geyer_autocorrelation_time`], at least 1. `None`
/// for residuals that are all zero, or none.
pub fn effective_samples(residuals: &[f64]) -> Option<f64> {
    let varies = residuals.iter().any(|r| *r != 0.0) && residuals.iter().all(|r| r.is_finite());
    varies.then(|| (residuals.len() as f64 / geyer_autocorrelation_time(residuals)).max(1.0))
}

/// `1 + 2 sum r_k` up to the first lag that is five times the sum so far (Sokal's window), at least 1.
///
/// In samples: the mean of `N` such residuals has the variance of `N` over this many independent ones. Sokal, *Monte
/// Carlo Methods in Statistical Mechanics*, 1989.
pub fn sokal_autocorrelation_time(residual: &[f64]) -> f64 {
    let energy = dot(residual, residual);
    if energy <= 0.0 || !energy.is_finite() {
        return 1.0;
    }
    let mut time = 1.0;
    for lag in 1..residual.len() {
        if lag as f64 > 5.0 * time {
            break;
        }
        time += 2.0 * dot(&residual[lag..], &residual[..residual.len() - lag]) / energy;
        if time < 1.0 {
            return 1.0;
        }
    }
    time
}

/// Number of independent samples that correlated residuals are worth, `N (1 - rho)/(1 + rho)` with `rho` the lag-one
/// autocorrelation, from 2 to N: exact for a first-order autoregression.
pub fn autoregressive_effective_samples(residual: &[f64]) -> f64 {
    let n = residual.len() as f64;
    let energy = dot(residual, residual);
    if residual.len() < 2 || energy <= 0.0 {
        return n;
    }
    let rho = (dot(&residual[1..], &residual[..residual.len() - 1]) / energy).clamp(0.0, 1.0);
    (n * (1.0 - rho) / (1.0 + rho)).max(2.0_f64.min(n))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    #[test]
    fn tells_smooth_from_alternating() {
        let smooth: Vec<f64> = (0..200).map(|k| (f64::from(k) * 0.03).sin()).collect();
        assert!(lag_1_autocorrelation(&smooth) > 0.98);
        let alternating: Vec<f64> = (0..200).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert_eq!(lag_1_autocorrelation(&alternating), 0.0);
        assert_eq!(lag_1_autocorrelation(&[0.0; 5]), 0.0);
        assert_eq!((geyer_autocorrelation_time(&alternating), geyer_autocorrelation_time(&[0.0; 5])), (1.0, 1.0));
    }

    #[test]
    fn long_residuals_go_by_the_transform_and_agree() {
        // A first-order autoregression of a known generator, and residuals of one sign, which no lag ends.
        let mut state = 1_u64;
        let mut last = 0.0;
        let noise: Vec<f64> = (0..DIRECT_UP_TO + 1000)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                last = 0.9 * last + (state >> 11) as f64 * 0.5_f64.powi(53) - 0.5;
                last
            })
            .collect();
        let transformed = all_lags(&noise);
        let power = at_lag(&noise, 0);
        for lag in [0, 1, 7, 100, 5000] {
            // Rounding of two transforms of 2^16 samples.
            assert!((transformed[lag] - at_lag(&noise, lag)).abs() < 1e-12 * power, "{lag}");
        }
        let time = geyer_autocorrelation_time(&vec![1.0; 1_000_000]);
        // 1 + 2 sum (1 - k/N) = N.
        assert!((time / 1e6 - 1.0).abs() < 1e-9, "{time}");
    }

    #[test]
    fn a_swing_counts_three_samples_a_period() {
        let swing: Vec<f64> = (0..1000).map(|k| (f64::from(k) * 0.01 * std::f64::consts::PI).sin()).collect();
        // Five periods: 1 + 2 (half a swing of a cosine, 50/pi·2) = 64; the window's ends take a little off.
        let time = geyer_autocorrelation_time(&swing);
        assert!((50.0..=70.0).contains(&time), "{time}");
        // About three samples a period.
        let worth = effective_samples(&swing).unwrap();
        assert!((14.0..=20.0).contains(&worth), "{worth}");
        assert_eq!((effective_samples(&[0.0; 4]), effective_samples(&[])), (None, None));
        assert_eq!(effective_samples(&[1.0, -1.0, 1.0, -1.0]), Some(4.0));
    }
}

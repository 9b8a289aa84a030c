//! How residuals hang together in time, and what that leaves of their number.

/// Lag-1 autocorrelation of residuals, within 0 and 0.999 999; 0 for residuals that do not vary.
///
/// White residuals give about 0; the smooth misfit of a model to a crash gives nearly 1.
pub(crate) fn lag_1_autocorrelation(residuals: &[f64]) -> f64 {
    let mean = residuals.iter().sum::<f64>() / residuals.len().max(1) as f64;
    let power: f64 = residuals.iter().map(|r| (r - mean).powi(2)).sum();
    if power == 0.0 || !power.is_finite() {
        return 0.0;
    }
    let product: f64 = residuals.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum();
    (product / power).clamp(0.0, 0.999_999)
}

/// Autocovariance of residuals about zero at lags 0 .. `lags`, each divided by their number (so that any triangular window of
/// it is positive semidefinite).
pub(crate) fn autocovariance(residuals: &[f64], lags: usize) -> Vec<f64> {
    let n = residuals.len().max(1) as f64;
    (0..lags.min(residuals.len()))
        .map(|lag| crumple_lti::dot(&residuals[lag..], &residuals[..residuals.len() - lag]) / n)
        .collect()
}

/// First lag at which the autocovariance is not positive; at least 1.
pub(crate) fn first_zero_lag(covariance: &[f64]) -> usize {
    covariance.iter().skip(1).position(|c| *c <= 0.0).map_or(covariance.len(), |k| k + 1).max(1)
}

/// Autocorrelation time in samples: `1 + 2 sum r_k` over the lags before the first that is not positive; at least 1.
///
/// Geyer's initial positive sequence. A slow swing of `m` periods in the window counts as about `3 m` samples.
pub(crate) fn autocorrelation_time(residuals: &[f64]) -> f64 {
    let covariance = autocovariance(residuals, residuals.len());
    match covariance.first() {
        Some(power) if *power > 0.0 => {
            let sum: f64 = covariance[1..first_zero_lag(&covariance)].iter().sum();
            (1.0 + 2.0 * sum / power).max(1.0)
        }
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tells_smooth_from_alternating() {
        let smooth: Vec<f64> = (0..200).map(|k| (f64::from(k) * 0.03).sin()).collect();
        assert!(lag_1_autocorrelation(&smooth) > 0.98);
        let alternating: Vec<f64> = (0..200).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert_eq!(lag_1_autocorrelation(&alternating), 0.0);
        assert_eq!(lag_1_autocorrelation(&[0.0; 5]), 0.0);
        assert_eq!((autocorrelation_time(&alternating), autocorrelation_time(&[0.0; 5])), (1.0, 1.0));
    }

    #[test]
    fn a_swing_counts_three_samples_a_period() {
        let swing: Vec<f64> = (0..1000).map(|k| (f64::from(k) * 0.01 * std::f64::consts::PI).sin()).collect();
        // Five periods: 1 + 2 (half a swing of a cosine, 50/pi·2) = 64; the window's ends take a little off.
        let time = autocorrelation_time(&swing);
        assert!((50.0..=70.0).contains(&time), "{time}");
    }
}

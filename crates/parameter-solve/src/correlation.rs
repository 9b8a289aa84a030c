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
    }
}

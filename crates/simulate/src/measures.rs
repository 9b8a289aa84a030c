//! Measures of fit.

/// `100 (1 - |y - yh| / |y - mean(y)|)`: 100 for a perfect model, 0 for one no better than the mean, negative for
/// worse. `None` for samples that do not vary (the measure is undefined, not 100), none at all, of unequal number, or so
/// far apart that their squares leave the range of numbers.
///
/// The simulation figure of MATLAB's `compare`, except that no initial state is estimated: a crash starts from
/// `x = 0, v = v0`.
pub fn fit_percent(measured: &[f64], modelled: &[f64]) -> Option<f64> {
    if measured.is_empty() || measured.len() != modelled.len() {
        return None;
    }
    let mean = measured.iter().sum::<f64>() / measured.len() as f64;
    let spread: f64 = measured.iter().map(|y| (y - mean).powi(2)).sum();
    let error: f64 = measured.iter().zip(modelled).map(|(y, yh)| (y - yh).powi(2)).sum();
    (spread > 0.0).then(|| 100.0 * (1.0 - (error / spread).sqrt())).filter(|fit| fit.is_finite())
}

/// Root mean square error; `None` without samples, for unequal numbers of them, or beyond the range of numbers.
pub fn rmse(measured: &[f64], modelled: &[f64]) -> Option<f64> {
    if measured.is_empty() || measured.len() != modelled.len() {
        return None;
    }
    let error: f64 = measured.iter().zip(modelled).map(|(y, yh)| (y - yh).powi(2)).sum();
    Some((error / measured.len() as f64).sqrt()).filter(|rmse| rmse.is_finite())
}

/// Largest absolute error; `None` without samples, for unequal numbers of them, or beyond the range of numbers.
pub fn max_abs_error(measured: &[f64], modelled: &[f64]) -> Option<f64> {
    if measured.len() != modelled.len() {
        return None;
    }
    measured.iter().zip(modelled).map(|(y, yh)| (y - yh).abs()).max_by(f64::total_cmp).filter(|e| e.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_fits_zero_percent_and_the_record_itself_a_hundred() {
        let y = [1.0, 2.0, 6.0];
        assert_eq!(fit_percent(&y, &y), Some(100.0));
        assert_eq!(fit_percent(&y, &[3.0; 3]), Some(0.0));
        assert_eq!(fit_percent(&[2.0; 3], &y), None);
        assert_eq!(fit_percent(&y, &y[..2]), None);
        assert_eq!((fit_percent(&y, &[1e200; 3]), rmse(&y, &[1e200; 3])), (None, None), "squares overflow");
    }

    #[test]
    fn errors_are_those_of_the_samples() {
        assert_eq!(rmse(&[0.0, 0.0], &[3.0, 4.0]), Some(12.5_f64.sqrt()));
        assert_eq!(max_abs_error(&[0.0, 0.0], &[3.0, -4.0]), Some(4.0));
        assert_eq!((rmse(&[], &[]), max_abs_error(&[], &[])), (None, None));
    }
}

//! How well a model's response follows a record.

/// `100 (1 - |y - yh| / |y - mean y|)`: 100 is perfect, 0 is as good as the mean, negative is worse.
///
/// `None` where it is undefined: a constant record, different lengths, or a response that has overflowed.
pub fn fit_percent(measured: &[f64], model: &[f64]) -> Option<f64> {
    let mean = measured.iter().sum::<f64>() / measured.len() as f64;
    let spread = distance(measured, &vec![mean; measured.len()])?;
    let fit = 100.0 * (1.0 - distance(measured, model)? / spread);
    (spread > 0.0 && fit.is_finite()).then_some(fit)
}

/// Root mean square of `y - yh`, in the unit of the record; `None` as for [`fit_percent`], except that a constant
/// record has one.
pub fn rmse(measured: &[f64], model: &[f64]) -> Option<f64> {
    Some(distance(measured, model)? / (measured.len() as f64).sqrt())
}

/// Fit of several records together: `100 (1 - |all errors| / |all deviations from each record's mean|)`, so that a record
/// counts by its size. For one record that of [`fit_percent`].
pub(crate) fn common_fit_percent(pairs: &[(&[f64], &[f64])]) -> Option<f64> {
    if let [(measured, model)] = pairs {
        return fit_percent(measured, model);
    }
    let (mut missed, mut spread) = (0.0, 0.0);
    for (measured, model) in pairs {
        let mean = measured.iter().sum::<f64>() / measured.len() as f64;
        spread += distance(measured, &vec![mean; measured.len()])?.powi(2);
        missed += distance(measured, model)?.powi(2);
    }
    let fit = 100.0 * (1.0 - (missed / spread).sqrt());
    (spread > 0.0 && fit.is_finite()).then_some(fit)
}

/// Root mean square error of several records together.
pub(crate) fn common_rmse(pairs: &[(&[f64], &[f64])]) -> Option<f64> {
    if let [(measured, model)] = pairs {
        return rmse(measured, model);
    }
    let count: usize = pairs.iter().map(|(measured, _)| measured.len()).sum();
    let missed = pairs.iter().map(|(measured, model)| Some(distance(measured, model)?.powi(2))).sum::<Option<f64>>()?;
    Some((missed / count as f64).sqrt()).filter(|rmse| rmse.is_finite())
}

/// Euclidean distance; `None` if the lengths differ, are zero, or the result is not finite.
fn distance(a: &[f64], b: &[f64]) -> Option<f64> {
    if a.len() != b.len() || a.is_empty() {
        return None;
    }
    Some(a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()).filter(|d| d.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn perfect_mean_and_worse() {
        let y = [1.0, 2.0, 3.0, 6.0];
        assert_eq!(fit_percent(&y, &y), Some(100.0));
        assert_eq!(fit_percent(&y, &[3.0; 4]), Some(0.0));
        assert!(fit_percent(&y, &[-9.0; 4]).unwrap() < 0.0);
        assert_eq!(rmse(&y, &[1.0, 2.0, 3.0, 4.0]), Some(1.0));
    }

    #[test]
    fn undefined_for_a_constant_record_and_an_overflown_response() {
        assert_eq!(fit_percent(&[2.0; 3], &[2.0; 3]), None);
        assert_eq!(fit_percent(&[1.0, 2.0], &[1.0, f64::INFINITY]), None);
        assert_eq!(rmse(&[1.0], &[1.0, 2.0]), None);
    }
}

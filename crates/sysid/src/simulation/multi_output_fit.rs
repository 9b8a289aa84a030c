//! How well a model of several outputs follows all records together.

use crumple_metrics::{fit_percent, rmse};

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
///
/// `sqrt(sum of all squared errors / number of all samples)`, in the unit that the records share.
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
    fn records_count_by_their_size() {
        let (y, z) = ([1.0, 3.0], [10.0, 30.0]);
        // Deviations 2 + 200 squared, errors 2 of the small record only: 1 - sqrt(2/202).
        let fit = common_fit_percent(&[(&y, &[2.0, 2.0]), (&z, &z)]).unwrap();
        assert!((fit - 100.0 * (1.0 - (2.0_f64 / 202.0).sqrt())).abs() < 1e-12, "{fit}");
        assert_eq!(common_rmse(&[(&y, &[2.0, 2.0]), (&z, &z)]), Some((2.0_f64 / 4.0).sqrt()));
        assert_eq!(common_fit_percent(&[(&y, &y)]), fit_percent(&y, &y));
        assert_eq!(common_rmse(&[(&y, &[1.0]), (&z, &z)]), None);
    }
}

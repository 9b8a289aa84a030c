//! Measures of fit that are no metric of `crumple-metrics`.

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
    fn the_largest_error_is_that_of_a_sample() {
        assert_eq!(max_abs_error(&[0.0, 0.0], &[3.0, -4.0]), Some(4.0));
        assert_eq!((max_abs_error(&[], &[]), max_abs_error(&[1.0], &[])), (None, None));
    }
}

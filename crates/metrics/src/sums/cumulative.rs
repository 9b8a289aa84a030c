//! Cumulative trapezoid and reading it between samples.

/// Cumulative trapezoid from 0: `V[0] = 0`, `V[k] = V[k-1] + T·(a[k-1] + a[k])/2`.
pub(crate) fn cumulative(a: &[f64], dt_s: f64) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = a.windows(2).map(|pair| {
        sum += dt_s * (pair[0] + pair[1]) / 2.0;
        sum
    });
    a.first().map(|_| 0.0).into_iter().chain(steps).collect()
}

/// Cumulative trapezoid of the trapezoid: also the second integral.
pub(crate) fn from(start: f64, rate: &[f64], dt_s: f64) -> Vec<f64> {
    let mut sums = cumulative(rate, dt_s);
    sums.iter_mut().for_each(|sum| *sum += start);
    sums
}

/// A length of time in whole samples and the fraction that is left, with a slack for decimal intervals.
///
/// `None` if it is negative, not finite, or longer than any record.
pub(crate) fn in_samples(length_s: f64, dt_s: f64) -> Option<(usize, f64)> {
    let x = length_s / dt_s;
    if !(0.0..9e15).contains(&x) {
        return None;
    }
    let nearest = x.round();
    // 1e-9 s is the slack of the definitions for windows; never more than a part of a sample.
    if (x - nearest).abs() * dt_s <= 1e-9_f64.min(1e-3 * dt_s) {
        return Some((nearest as usize, 0.0));
    }
    Some((x.floor() as usize, x - x.floor()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_by_the_trapezoid() {
        assert_eq!(cumulative(&[0.0, 2.0, 4.0], 0.5), [0.0, 0.5, 2.0]);
        assert!(cumulative(&[], 0.5).is_empty());
        assert_eq!(from(4.0, &[2.0, 2.0], 0.5), [4.0, 5.0]);
    }

    #[test]
    fn a_decimal_window_is_whole_samples() {
        assert_eq!(in_samples(0.015, 1e-4), Some((150, 0.0)));
        assert_eq!(in_samples(0.75, 0.5), Some((1, 0.5)));
        // Intervals below 1 µs: the slack is a thousandth of one, not 1 ns.
        assert_eq!(in_samples(100.0e-8, 1e-8), Some((100, 0.0)));
        assert!(in_samples(100.01e-8, 1e-8).is_some_and(|(whole, part)| whole == 100 && part > 0.0));
        assert_eq!(in_samples(1.0 + 0.9e-9, 0.5), Some((2, 0.0)));
        assert!(in_samples(1.0 + 2e-9, 0.5).is_some_and(|(whole, part)| whole == 2 && part > 0.0));
        assert_eq!(in_samples(-0.1, 0.5), None);
        assert_eq!(in_samples(f64::NAN, 0.5), None);
    }
}

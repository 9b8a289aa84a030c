use crate::{Coefficients, FilterError};

/// Samples of which the mean starts a pass.
const START_SAMPLES: usize = 10;
/// Shortest extension, samples, as long as the record has them.
const SHORTEST_EXTENSION: usize = 100;
/// Shortest extension, s.
const EXTENSION_S: f64 = 0.01;
/// Fewest samples: with 3 mirrored on either side they are the ten that start a pass.
const FEWEST_SAMPLES: usize = 4;

/// Samples mirrored at each end: 10 ms, but at least 100, and never more than the record has to mirror.
pub fn samples_added(samples: usize, coefficients: &Coefficients) -> usize {
    if !coefficients.mode().extends() {
        return 0;
    }
    // A float-to-integer cast saturates, so a tiny interval ends at the length of the record.
    ((EXTENSION_S / coefficients.dt_s()).round() as usize).max(SHORTEST_EXTENSION).min(samples.saturating_sub(1))
}

/// Subtracts the zero level, then filters forward and backward: no phase, so events keep their times.
///
/// `iso6487` and `sae_reflect` first extend both ends by point reflection about the end sample, `2·x[0] - x[i]` and
/// `2·x[N-1] - x[N-1-i]`; each pass starts from the mean of the first ten samples it meets, the recursion from the
/// third. `sae_zero_state` extends nothing and starts each pass from rest, so a record that is not at rest at its
/// ends is wrong over some 10 ms there: half the first sample is missing.
///
/// The filter spreads a jump over about ±10 ms at CFC 60, to both sides. Rounding: about 1e-13 of the largest sample.
/// ISO 6487 Annex A; SAE J211-1 Appendix C leaves the ends to the user.
pub fn filter_both_ways(
    samples: &[f64],
    zero_level: f64,
    coefficients: &Coefficients,
) -> Result<Vec<f64>, FilterError> {
    let n = samples.len();
    if n < FEWEST_SAMPLES {
        return Err(FilterError::TooShort { samples: n });
    }
    let mirrored = coefficients.mode().extends();
    let added = samples_added(n, coefficients);
    let (first, last) = (samples[0] - zero_level, samples[n - 1] - zero_level);

    let mut work = Vec::with_capacity(n + 2 * added);
    work.extend(samples[1..=added].iter().rev().map(|x| 2.0 * first - (x - zero_level)));
    work.extend(samples.iter().map(|x| x - zero_level));
    work.extend(samples[n - 1 - added..n - 1].iter().rev().map(|x| 2.0 * last - (x - zero_level)));

    let start = if mirrored { mean(&work[..START_SAMPLES]) } else { 0.0 };
    pass(work.iter_mut(), coefficients, start);
    let start = if mirrored { mean(&work[work.len() - START_SAMPLES..]) } else { 0.0 };
    pass(work.iter_mut().rev(), coefficients, start);

    work.copy_within(added..added + n, 0);
    work.truncate(n);
    Ok(work)
}

fn mean(samples: &[f64]) -> f64 {
    samples.iter().sum::<f64>() / samples.len() as f64
}

/// One pass in place: the first two outputs are `start`, the difference equation from the third on.
fn pass<'a>(mut samples: impl Iterator<Item = &'a mut f64>, c: &Coefficients, start: f64) {
    let (Some(first), Some(second)) = (samples.next(), samples.next()) else { return };
    let (mut x2, mut x1) = (std::mem::replace(first, start), std::mem::replace(second, start));
    let (mut y2, mut y1) = (start, start);
    for sample in samples {
        let x = *sample;
        // Summed in the order of the standard's equation: another order gives other last digits.
        let y = c.a0 * x + c.a1 * x1 + c.a2 * x2 + c.b1 * y1 + c.b2 * y2;
        *sample = y;
        (x2, x1) = (x1, x);
        (y2, y1) = (y1, y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cfc, Mode};

    #[test]
    fn the_extension_is_ten_milliseconds_a_hundred_samples_or_the_record() {
        let added = |samples, dt_s, mode| samples_added(samples, &Coefficients::new(Cfc::Cfc60, mode, dt_s));
        assert_eq!(added(5000, 1e-4, Mode::Iso6487), 100);
        assert_eq!(added(5000, 5e-5, Mode::Iso6487), 200);
        assert_eq!(added(5000, 1e-3, Mode::SaeReflect), 100);
        assert_eq!(added(51, 1e-4, Mode::Iso6487), 50);
        assert_eq!(added(51, 1e-300, Mode::Iso6487), 50);
        assert_eq!(added(5000, 1e-4, Mode::SaeZeroState), 0);
    }

    #[test]
    fn four_samples_are_enough_and_three_are_refused() {
        let coefficients = Coefficients::new(Cfc::Cfc60, Mode::Iso6487, 1e-4);
        let error = filter_both_ways(&[1.0; 3], 0.0, &coefficients).unwrap_err();
        assert_eq!(
            error.to_string(),
            "3 samples are too few for a channel frequency class filter, at least 4 are needed"
        );
        for y in filter_both_ways(&[7.0; 4], 2.0, &coefficients).unwrap() {
            // DC gain 1, and the start state is the constant itself: rounding only.
            assert!((y - 5.0).abs() < 1e-12, "{y}");
        }
    }
}

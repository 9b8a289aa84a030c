//! Both passes of a class filter over a record, and what happens at its ends.

use crate::recursion::Recursion;
use crate::{Coefficients, FilterError};

/// Samples of which the mean starts a pass.
const START_SAMPLES: usize = 10;
/// Shortest extension, samples, as long as the record has them.
const SHORTEST_EXTENSION: usize = 100;
/// Shortest extension, s.
const EXTENSION_S: f64 = 0.01;
/// Fewest samples: with 3 mirrored on either side they are the ten that start a pass.
const FEWEST_SAMPLES: usize = 4;
/// Samples between two reports of progress.
const BLOCK: usize = 1 << 16;

/// Told how many samples have gone through a pass since the last call. Work on a record of n samples is 2·n of them.
pub type Report<'a> = &'a (dyn Fn(u64) + Sync);

/// Samples mirrored at each end: 10 ms, but at least 100, and never more than the record has to mirror:
/// `min(max(round(0.01/T), 100), N - 1)`; 0 for `sae_zero_state`.
///
/// What a pass remembers of its start decays as `e^(-2π·CFC·κ·t/√2)`: over 10 ms to about 0.4 % at CFC 60 and 6e-8 at
/// CFC 180.
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
/// Memory: the result. ISO 6487 Annex A; SAE J211-1 Appendix C leaves the ends to the user.
///
/// The ends are the part where implementations differ. The point reflection keeps value and slope of the record across
/// its end; a reflection about zero keeps neither. Zero-phase routines that add nine samples unless told otherwise
/// differ from this by up to 1 g at the ends of a ringing pulse at CFC 60.
///
/// # Errors
/// Fewer than four samples. Samples near the end of the range of numbers give infinities here, which the caller has to
/// look for.
pub fn filter_both_ways(
    samples: &[f64],
    zero_level: f64,
    coefficients: &Coefficients,
) -> Result<Vec<f64>, FilterError> {
    let mut output = Vec::new();
    filter_both_ways_into(samples, zero_level, coefficients, &mut output, &|_| ())?;
    Ok(output)
}

/// [`filter_both_ways`] into a buffer whose memory is used again, with a report of progress: every sample is told
/// twice, once a pass. `output` is cleared first and has the length of `samples` afterwards.
pub fn filter_both_ways_into(
    samples: &[f64],
    zero_level: f64,
    coefficients: &Coefficients,
    output: &mut Vec<f64>,
    report: Report<'_>,
) -> Result<(), FilterError> {
    let n = samples.len();
    if n < FEWEST_SAMPLES {
        return Err(FilterError::TooShort { samples: n });
    }
    let mirrored = coefficients.mode().extends();
    let added = samples_added(n, coefficients);
    let (first, last) = (samples[0] - zero_level, samples[n - 1] - zero_level);
    // The extensions are short and apart from the record, so that nothing of its length is moved.
    let mut left: Vec<f64> = samples[1..=added].iter().rev().map(|x| 2.0 * first - (x - zero_level)).collect();
    let mut right: Vec<f64> =
        samples[n - 1 - added..n - 1].iter().rev().map(|x| 2.0 * last - (x - zero_level)).collect();

    output.clear();
    output.reserve_exact(n);
    let head = left.iter().copied().chain(samples.iter().map(|x| x - zero_level)).chain(right.iter().copied());
    let start = if mirrored { mean(&head.take(START_SAMPLES).collect::<Vec<_>>()) } else { 0.0 };
    let mut rest = samples;
    let mut pass = if let Some((two, rest_of_left)) = left.split_first_chunk_mut::<2>() {
        let mut pass = Recursion::new(coefficients.to_array(), *two, start);
        *two = [start; 2];
        pass.in_place(rest_of_left.iter_mut());
        pass
    } else {
        rest = &samples[2..];
        output.extend([start; 2]);
        Recursion::new(coefficients.to_array(), [samples[0] - zero_level, samples[1] - zero_level], start)
    };
    for block in rest.chunks(BLOCK) {
        pass.append(block, zero_level, output);
        report(block.len() as u64);
    }
    pass.in_place(right.iter_mut());

    let tail = right.iter().rev().chain(output.iter().rev()).chain(left.iter().rev()).take(START_SAMPLES).copied();
    let mut tail: Vec<f64> = tail.collect();
    tail.reverse();
    let start = if mirrored { mean(&tail) } else { 0.0 };
    // What the second pass makes of the left extension is never looked at.
    let mut rest = output.as_mut_slice();
    let mut pass = if let Some((rest_of_right, two)) = right.split_last_chunk_mut::<2>() {
        let mut pass = Recursion::new(coefficients.to_array(), [two[1], two[0]], start);
        pass.in_place(rest_of_right.iter_mut().rev());
        pass
    } else {
        let (rest_of_output, two) = rest.split_at_mut(n - 2);
        let pass = Recursion::new(coefficients.to_array(), [two[1], two[0]], start);
        two.fill(start);
        rest = rest_of_output;
        pass
    };
    for block in rest.rchunks_mut(BLOCK) {
        pass.in_place(block.iter_mut().rev());
        report(block.len() as u64);
    }
    Ok(())
}

/// Arithmetic mean, the state from which a pass starts.
fn mean(samples: &[f64]) -> f64 {
    samples.iter().sum::<f64>() / samples.len() as f64
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

    /// The definition, word for word: one long extended record, two passes over all of it.
    fn as_written(samples: &[f64], zero_level: f64, c: &Coefficients) -> Vec<f64> {
        let (n, added) = (samples.len(), samples_added(samples.len(), c));
        let x: Vec<f64> = samples.iter().map(|x| x - zero_level).collect();
        let mut work: Vec<f64> = (1..=added).rev().map(|i| 2.0 * x[0] - x[i]).collect();
        work.extend(&x);
        work.extend((1..=added).map(|i| 2.0 * x[n - 1] - x[n - 1 - i]));
        for _ in 0..2 {
            let start = if added > 0 { work[..10].iter().sum::<f64>() / 10.0 } else { 0.0 };
            let x = std::mem::take(&mut work);
            work.extend([start; 2]);
            for i in 2..x.len() {
                let sum = c.a0 * x[i] + c.a1 * x[i - 1] + c.a2 * x[i - 2];
                work.push(sum + c.b1 * work[i - 1] + c.b2 * work[i - 2]);
            }
            work.reverse();
        }
        work[added..added + n].to_vec()
    }

    #[test]
    fn blocks_and_separate_extensions_change_nothing_but_the_order_of_a_mean() {
        for mode in [Mode::Iso6487, Mode::SaeReflect, Mode::SaeZeroState] {
            let c = Coefficients::new(Cfc::Cfc180, mode, 1e-4);
            for n in [4, 5, 7, 99, 101, 350, BLOCK + 3, 2 * BLOCK + 2] {
                let samples: Vec<f64> = (0..n).map(|k| 40.0 * (0.05 * k as f64).sin() + (k % 7) as f64).collect();
                let filtered = filter_both_ways(&samples, 0.3, &c).unwrap();
                for (y, z) in filtered.iter().zip(as_written(&samples, 0.3, &c)) {
                    // The start of the second pass is a mean of ten numbers up to 50, summed from the other end.
                    assert!((y - z).abs() < 1e-13, "{n} {mode:?}: {y} {z}");
                }
            }
        }
    }

    #[test]
    fn progress_adds_up_to_two_passes() {
        let done = std::sync::atomic::AtomicU64::new(0);
        let samples = vec![1.0; BLOCK + 17];
        let c = Coefficients::new(Cfc::Cfc60, Mode::Iso6487, 1e-4);
        let add = |amount| {
            done.fetch_add(amount, std::sync::atomic::Ordering::Relaxed);
        };
        filter_both_ways_into(&samples, 0.0, &c, &mut Vec::new(), &add).unwrap();
        assert_eq!(done.into_inner(), 2 * samples.len() as u64);
    }
}

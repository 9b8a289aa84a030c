//! What an input does between its samples, as the samples show it: it stands still between jumps, or it is smooth and
//! straight lines between its samples lose some of it.

use std::f64::consts::PI;

use crate::data::spectrum;

/// Differences up to so many times their lower quartile are none: of normal noise the quartile is 0.32 deviations, so
/// that one difference in ten thousand is larger.
const BEYOND_NOISE: f64 = 12.0;

/// Differences up to this share of the largest magnitude are rounding.
const ROUNDING: f64 = 1e-9;

/// Jumps of a staircase follow one another so rarely: a stretch that moves has at most so many on average.
const JUMPS_IN_A_ROW: f64 = 1.5;

/// Between its jumps a staircase varies by this share of a jump at most, root mean square; a sawtooth by 0.29.
const STANDS_STILL: f64 = 0.05;

/// Share of the jumps that are one step of the resolution in a signal that a coarse sensor rounds.
const BY_RESOLUTION: f64 = 0.9;

/// Share of the power above half of the Nyquist frequency up to which samples tell what lies between them (Shannon,
/// Proc. IRE 37, 1949). White noise has half of its power there.
const BEYOND_HALF: f64 = 0.01;

/// Whether a signal stands still between jumps: it is a staircase, and its samples hold until the next.
///
/// Jumps are differences beyond rounding and noise. They stand alone, or the signal knows two levels. Not told: a
/// staircase with a new value at every sample. A slow signal that a coarse sensor rounds jumps by one step of the
/// resolution at no common multiple of a number of samples, and is none.
pub fn is_staircase(signal: &[f64]) -> bool {
    let steps: Vec<f64> = signal.windows(2).map(|w| w[1] - w[0]).collect();
    let mut sizes: Vec<f64> = steps.iter().map(|d| d.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let Some(quartile) = sizes.get(sizes.len() / 4) else { return false };
    let largest = signal.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let limit = (BEYOND_NOISE * quartile).max(ROUNDING * largest);
    let jumps: Vec<usize> = (0..steps.len()).filter(|k| steps[*k].abs() > limit).collect();
    let stretches = jumps.iter().enumerate().filter(|(i, k)| *i == 0 || jumps[i - 1] + 1 < **k).count();
    let stand_alone = jumps.len() as f64 <= JUMPS_IN_A_ROW * stretches as f64;
    !jumps.is_empty()
        && (stand_alone || has_two_levels(signal))
        && stands_still(signal, &steps, &jumps)
        && !is_rounded(&steps, &jumps)
}

/// Whether there are two values and no more.
fn has_two_levels(signal: &[f64]) -> bool {
    let first = signal[0];
    let mut others = signal.iter().filter(|x| **x != first);
    others.next().is_some_and(|second| others.all(|x| x == second))
}

/// Whether what varies between the jumps is small against them.
fn stands_still(signal: &[f64], steps: &[f64], jumps: &[usize]) -> bool {
    let starts = std::iter::once(0).chain(jumps.iter().map(|k| k + 1));
    let ends = jumps.iter().map(|k| k + 1).chain([signal.len()]);
    let within: f64 = starts
        .zip(ends)
        .map(|(start, end)| {
            let stand = &signal[start..end];
            let mean = stand.iter().sum::<f64>() / stand.len() as f64;
            stand.iter().map(|x| (x - mean).powi(2)).sum::<f64>()
        })
        .sum();
    let square = jumps.iter().map(|k| steps[*k].powi(2)).sum::<f64>() / jumps.len() as f64;
    within / signal.len() as f64 <= STANDS_STILL * STANDS_STILL * square
}

/// Whether the jumps are those of a coarse resolution: nearly all of one size, over three levels or more, at times
/// without a common clock.
fn is_rounded(steps: &[f64], jumps: &[usize]) -> bool {
    let least = jumps.iter().map(|k| steps[*k].abs()).fold(f64::INFINITY, f64::min);
    let by_one = jumps.iter().filter(|k| steps[**k].abs() < 1.5 * least).count();
    let goes_on = jumps.windows(2).any(|w| steps[w[0]] * steps[w[1]] > 0.0);
    let clock = jumps.windows(2).map(|w| w[1] - w[0]).fold(0, greatest_common_divisor);
    goes_on && by_one as f64 >= BY_RESOLUTION * jumps.len() as f64 && clock < 2
}

fn greatest_common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// What straight lines between the samples of a smooth signal lose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineLoss {
    /// Share of the amplitude, mean over the power of the signal: a gain is found too high by as much.
    pub share: f64,
    /// Frequency of the largest power, cycles a sample.
    pub cycles_per_sample: f64,
}

/// The part of a signal that straight lines between its samples lose: `1 - (sin x/x)²`, `x = pi f dt`, the transform of
/// the triangle that a sample becomes (Oppenheim & Schafer, *Discrete-Time Signal Processing*, "linear interpolation").
///
/// `None` where samples do not tell: of a staircase, of a signal that is straight between its corners, and of one that
/// has more than 1 % of its power above half of the Nyquist frequency, so that it need not be smooth between samples.
/// The part that reaches an output is smaller for outputs that follow the input within the same sample.
pub fn line_loss(signal: &[f64]) -> Option<LineLoss> {
    let steps: Vec<f64> = signal.windows(2).map(|w| w[1] - w[0]).collect();
    if is_staircase(signal) || is_staircase(&steps) {
        return None;
    }
    let mean = signal.iter().sum::<f64>() / signal.len().max(1) as f64;
    let about_zero = signal.iter().map(|x| x - mean).collect();
    let power: Vec<f64> = spectrum(about_zero)?.iter().map(nalgebra::Complex::norm_sqr).collect();
    let whole: f64 = power.iter().sum();
    let lines = signal.len() as f64;
    let beyond: f64 = power.iter().enumerate().filter(|(k, _)| 4.0 * *k as f64 > lines).map(|(_, p)| p).sum();
    if !(whole > 0.0 && beyond <= BEYOND_HALF * whole) {
        return None;
    }
    let lost = |(k, p): (usize, &f64)| {
        let x = PI * k as f64 / lines;
        if k == 0 { 0.0 } else { p * (1.0 - (x.sin() / x).powi(2)) }
    };
    let share = power.iter().enumerate().map(lost).sum::<f64>() / whole;
    let peak = power.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?.0;
    Some(LineLoss { share, cycles_per_sample: peak as f64 / lines })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::estimation::random::{RandomNumbers, uniform_at};

    /// A value for every so many samples.
    fn held(samples: usize, every: usize) -> Vec<f64> {
        (0..samples).map(|k| uniform_at(1, k / every) - 0.5).collect()
    }

    fn wave(samples_per_period: f64) -> Vec<f64> {
        (0..1000).map(|k| (2.0 * PI * f64::from(k) / samples_per_period).sin()).collect()
    }

    #[test]
    fn staircases_are_told_by_their_stands() {
        assert!(is_staircase(&held(600, 2)) && is_staircase(&held(600, 7)));
        let step: Vec<f64> = (0..100).map(|k| f64::from(u8::from(k >= 30))).collect();
        assert!(is_staircase(&step));
        // Two levels that may change at every sample.
        let binary: Vec<f64> = (0..300).map(|k| if uniform_at(2, k) < 0.5 { -1.0 } else { 1.0 }).collect();
        assert!(is_staircase(&binary));
        // Stairs up in equal steps, by a clock.
        let stairs: Vec<f64> = (0..200).map(|k| f64::from(k / 20)).collect();
        assert!(is_staircase(&stairs));
        // Measured with noise of 1 % of the steps.
        let mut random = RandomNumbers::seeded(3);
        let noisy: Vec<f64> = held(600, 2).iter().map(|x| x + 0.003 * random.normal()).collect();
        assert!(is_staircase(&noisy));
    }

    #[test]
    fn other_signals_are_no_staircases() {
        assert!(!is_staircase(&held(600, 1)) && !is_staircase(&wave(10.0)) && !is_staircase(&[1.0; 50]));
        let sawtooth: Vec<f64> = (0..600).map(|k| f64::from(k % 20)).collect();
        assert!(!is_staircase(&sawtooth));
        // Half a sine, then rest; and the same rounded to a coarse resolution.
        let blow = |k: u32| if k < 40 { (PI * f64::from(k) / 40.0).sin() } else { 0.0 };
        let rounded = |y: f64| (20.0 * y).round() / 20.0;
        assert!(!is_staircase(&(0..400).map(blow).collect::<Vec<f64>>()));
        assert!(!is_staircase(&wave(400.0).into_iter().map(rounded).collect::<Vec<f64>>()));
        let mut random = RandomNumbers::seeded(4);
        let noise: Vec<f64> = (0..4000).map(|_| random.normal()).collect();
        assert!(!is_staircase(&noise));
        assert!(!is_staircase(&[]) && !is_staircase(&[1.0]));
    }

    #[test]
    fn lines_lose_what_the_transform_of_the_triangle_says() {
        let loss = line_loss(&wave(10.0)).unwrap();
        let x = 0.1 * PI;
        // The window of the spectrum spreads the line over three bins.
        assert!((loss.share - (1.0 - (x.sin() / x).powi(2))).abs() < 1e-4, "{loss:?}");
        assert!((loss.cycles_per_sample - 0.1).abs() < 1e-12);
        // A triangle is straight; of white noise and staircases nobody knows.
        let triangle: Vec<f64> = (0..600).map(|k: i32| f64::from((k % 20 - 10).abs())).collect();
        assert_eq!(line_loss(&triangle), None);
        assert_eq!((line_loss(&held(600, 1)), line_loss(&held(600, 2))), (None, None));
    }
}

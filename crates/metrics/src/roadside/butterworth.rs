//! The four-pole phaseless low-pass that EN 1317 asks for, and at another frequency every channel frequency class.

use std::f64::consts::{PI, SQRT_2};

/// Shortest extension of the ends, samples.
const SHORTEST_EXTENSION: usize = 100;
/// Shortest extension of the ends, s.
const EXTENSION_S: f64 = 0.01;
/// Samples of which the mean starts a pass.
const START_SAMPLES: usize = 10;

/// Design frequency of a pass over the channel frequency class, ISO 6487 Annex A.
const CLASS_FACTOR: f64 = 1.25 / 0.6;

/// Samples through a channel frequency class of SAE J211-1 and ISO 6487, as a laboratory filters them: forward and
/// backward, `class` 60, 180, 600 or 1000 Hz. `None` for fewer than four samples or a rate below 8.4 times the class.
pub fn through_class(samples: &[f64], dt_s: f64, class_hz: f64) -> Option<Vec<f64>> {
    two_pass(samples, dt_s, CLASS_FACTOR * class_hz)
}

/// Phaseless four-pole Butterworth low-pass: two poles forward, two backward, designed for `frequency_hz` in each pass.
///
/// The equation and the ends of the channel frequency classes (SAE J211-1 Appendix C; point reflection over at least
/// 10 ms and 100 samples, each pass started from the mean of the first ten), with `wd = 2π·frequency`: each pass leaves
/// 1/√2 there, both 1/2. Needs four samples and a frequency below a quarter of the sampling rate; `None` otherwise.
pub(crate) fn two_pass(samples: &[f64], dt_s: f64, frequency_hz: f64) -> Option<Vec<f64>> {
    let n = samples.len();
    if n < 4 || !(frequency_hz > 0.0 && frequency_hz * dt_s < 0.25) {
        return None;
    }
    let wa = (PI * frequency_hz * dt_s).tan();
    let d = 1.0 + SQRT_2 * wa + wa * wa;
    let a0 = wa * wa / d;
    let c = [a0, 2.0 * a0, a0, -2.0 * (wa * wa - 1.0) / d, (-1.0 + SQRT_2 * wa - wa * wa) / d];

    let added = ((EXTENSION_S / dt_s).round() as usize).max(SHORTEST_EXTENSION).min(n - 1);
    let (first, last) = (samples[0], samples[n - 1]);
    let mut work = Vec::with_capacity(n + 2 * added);
    work.extend(samples[1..=added].iter().rev().map(|x| 2.0 * first - x));
    work.extend_from_slice(samples);
    work.extend(samples[n - 1 - added..n - 1].iter().rev().map(|x| 2.0 * last - x));
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let start = mean(&work[..START_SAMPLES]);
    pass(work.iter_mut(), c, start);
    let start = mean(&work[work.len() - START_SAMPLES..]);
    pass(work.iter_mut().rev(), c, start);
    work.copy_within(added..added + n, 0);
    work.truncate(n);
    Some(work)
}

/// One pass in place; the first two outputs are `start`.
fn pass<'a>(mut samples: impl Iterator<Item = &'a mut f64>, [a0, a1, a2, b1, b2]: [f64; 5], start: f64) {
    let (Some(first), Some(second)) = (samples.next(), samples.next()) else { return };
    let (mut x2, mut x1) = (std::mem::replace(first, start), std::mem::replace(second, start));
    let (mut y2, mut y1) = (start, start);
    for sample in samples {
        let x = *sample;
        let y = a0 * x + a1 * x1 + a2 * x2 + b1 * y1 + b2 * y2;
        *sample = y;
        (x2, x1) = (x1, x);
        (y2, y1) = (y1, y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_falls_to_half_power_at_its_frequency_over_0_6() {
        // Each pass of second order is 1/(1 + (f/f0)^4)^(1/2) with f0 = 1.25 f at f = CFC/0.6: both leave
        // 1/(1 + 1.25^-4) = 0.7094, 3 dB within what the bilinear transform shifts at 10 kHz, 1e-3.
        let sine: Vec<f64> = (0..20_000).map(|k| (2.0 * PI * 100.0 * f64::from(k) * 1e-4).sin()).collect();
        let out = through_class(&sine, 1e-4, 60.0).unwrap();
        let gain = out[9_000..11_000].iter().fold(0.0, |m: f64, y| m.max(y.abs()));
        assert!((gain - 1.0 / (1.0 + 1.25_f64.powi(-4))).abs() < 1e-3, "{gain}");
    }

    #[test]
    fn passes_a_constant_and_halves_its_frequency() {
        let flat = two_pass(&[3.0; 50], 1e-3, 13.0).unwrap();
        // Gain 1 at rest. The feedback multiplies rounding by 1/(4 a0) = 160 at most: two passes of five products of 3,
        // each half of 4e-16.
        assert!(flat.iter().all(|y| (y - 3.0).abs() < 1e-12));
        let sine: Vec<f64> = (0..20_000).map(|k| (2.0 * PI * 13.0 * f64::from(k) * 1e-3).sin()).collect();
        let out = two_pass(&sine, 1e-3, 13.0).unwrap();
        // Phaseless, gain 1/2; what starts at the ends has died out, 520 time constants away. Left is the rounding of
        // the argument, some 1e-13 at 900 rad, and of two passes, 160 times 1e-15.
        assert!((9_000..11_000).all(|k| (out[k] - 0.5 * sine[k]).abs() < 1e-12));
        assert!(two_pass(&[1.0; 3], 1e-3, 13.0).is_none() && two_pass(&[1.0; 30], 0.1, 13.0).is_none());
    }
}

//! Low-pass filtering and thinning of records, for methods whose horizon counts in samples.

use std::f64::consts::PI;

use crumple_linalg::real_transform;

use crate::{IdentifyError, IoData};

/// Part of a signal's largest spectral line above which a frequency counts as part of the signal.
const LEVEL: f64 = 0.01;

/// Samples per period of the highest frequency that counts: room for the filter's edge.
const SAMPLES_PER_PERIOD: f64 = 8.0;

/// Half length of the anti-alias filter, in samples of the thinned record.
const HALF_LENGTH: usize = 3;

/// By how many samples a record can be thinned before a frequency that counts in any of its signals comes near the new
/// Nyquist frequency, and at most so far that `needed` samples are left. 1: leave it as it is.
///
/// The frequency is the highest whose line in the amplitude spectrum (straight line through the ends removed, Hann
/// window) reaches 1 % of the largest. Noise that broad is not told from a signal: a white one keeps every sample.
pub fn automatic_thinning(data: &IoData, needed: usize) -> usize {
    let samples = data.samples();
    let transform = real_transform(samples).forward;
    let mut highest = 0;
    for signal in data.inputs().iter().chain(data.outputs()) {
        let mut windowed = detrended(signal);
        for (k, x) in windowed.iter_mut().enumerate() {
            *x *= 0.5 - 0.5 * (2.0 * PI * (k as f64 + 0.5) / samples as f64).cos();
        }
        let mut spectrum = transform.make_output_vec();
        if transform.process(&mut windowed, &mut spectrum).is_err() {
            return 1;
        }
        let largest = spectrum.iter().map(|x| x.norm()).fold(0.0, f64::max);
        if let Some(last) = spectrum.iter().rposition(|x| x.norm() > LEVEL * largest) {
            highest = highest.max(last);
        }
    }
    // Line k is k cycles over the record.
    let by_band = samples as f64 / (SAMPLES_PER_PERIOD * highest.max(1) as f64);
    let by_length = samples as f64 / (needed + 2 * HALF_LENGTH) as f64;
    (by_band.min(by_length).floor() as usize).max(1)
}

fn detrended(signal: &[f64]) -> Vec<f64> {
    let n = signal.len();
    let (first, last) = (signal[0], signal[n - 1]);
    let slope = if n > 1 { (last - first) / (n - 1) as f64 } else { 0.0 };
    signal.iter().enumerate().map(|(k, x)| x - first - slope * k as f64).collect()
}

/// Every `every`-th sample behind a symmetric low-pass filter, the same for all signals, so that a linear system
/// between them stays one with the same poles. Three thinned samples at each end, which the filter cannot reach, go.
///
/// Windowed sinc (Hann) with its half-amplitude point at the new Nyquist frequency. Between the thinned samples an
/// input is no longer held, so the input matrices found on such data are approximate: find them on the whole record.
/// Errors: nothing left.
pub fn thinned(data: &IoData, every: usize) -> Result<IoData, IdentifyError> {
    if every <= 1 {
        return Ok(data.clone());
    }
    let half = HALF_LENGTH * every;
    let mut filter: Vec<f64> = (0..=2 * half)
        .map(|k| {
            let x = (k as f64 - half as f64) / every as f64;
            let sinc = if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) };
            sinc * (0.5 + 0.5 * (PI * (k as f64 - half as f64) / (half as f64 + 1.0)).cos())
        })
        .collect();
    let sum: f64 = filter.iter().sum();
    filter.iter_mut().for_each(|f| *f /= sum);
    let cut = |signals: &[Vec<f64>]| -> Vec<Vec<f64>> {
        signals
            .iter()
            .map(|s| s.windows(filter.len()).step_by(every).map(|w| crumple_linalg::dot(w, &filter)).collect())
            .collect()
    };
    IoData::new(cut(data.inputs()), cut(data.outputs()), data.sample_time_s() * every as f64)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_estimation::random::uniform_at;

    fn wave(frequency_hz: f64, noise: f64) -> IoData {
        let y = (0..2000)
            .map(|k| (2.0 * PI * frequency_hz * f64::from(k) * 1e-4).sin() + noise * (uniform_at(0, k as usize) - 0.5));
        IoData::new(Vec::new(), vec![y.collect()], 1e-4).unwrap()
    }

    #[test]
    fn the_step_follows_the_band_and_noise_keeps_everything() {
        // 10 kHz / (8 * 100 Hz) = 12.5, a line or two wider by the window.
        assert!((10..=12).contains(&automatic_thinning(&wave(100.0, 0.0), 20)));
        assert_eq!(automatic_thinning(&wave(100.0, 0.0), 500), 3);
        assert_eq!(automatic_thinning(&wave(100.0, 2.0), 20), 1);
        assert_eq!(automatic_thinning(&wave(100.0, 0.0), 5000), 1);
    }

    #[test]
    fn a_slow_wave_passes_and_a_fast_one_does_not() {
        let slow = thinned(&wave(50.0, 0.0), 10).unwrap();
        let size = |data: &IoData| data.outputs()[0].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        // 50 Hz is a tenth of the new Nyquist frequency: within the ripple of the window.
        assert!((size(&slow) - 1.0).abs() < 0.02, "{}", size(&slow));
        assert!((slow.sample_time_s() - 1e-3).abs() < 1e-18 && slow.samples() == 194);
        assert!(size(&thinned(&wave(1500.0, 0.0), 10).unwrap()) < 0.02);
    }
}

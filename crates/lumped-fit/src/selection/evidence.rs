//! How much a record says for one model over another: the corrected Akaike criterion of misfits as measured.

use std::f64::consts::PI;

use crumple_numerics::estimation::statistics::InformationCriteria;

use crate::record::observation::Observation;

/// Autocorrelation at which its sum ends: below it, noise of the estimate.
const UNCORRELATED: f64 = 0.05;
/// Share of a record's root mean square to which a sensor is known: a misfit below it says nothing.
const SENSOR: f64 = 1e-3;
/// Independent samples that a criterion needs beside the numbers it charges: with one, its correction for short records
/// is infinite.
const TO_SPARE: f64 = 2.0;

/// Root mean square of a misfit with what no sensor knows of a record, a thousandth of its own, in quadrature. Infinite
/// without samples.
pub fn visible_misfit(misfit: &[f64], record_rms: f64) -> f64 {
    let mean_square = misfit.iter().map(|e| e * e).sum::<f64>() / misfit.len() as f64;
    let rms = mean_square.sqrt().hypot(SENSOR * record_rms);
    if rms.is_finite() { rms } else { f64::INFINITY }
}

/// Independent samples in a misfit of `N` samples: `N/(1 + 2 sum rho_k)`, summed up to where the autocorrelation first
/// falls below 0.05; at most what the filter lets through.
///
/// What no sensor knows counts as white noise: a misfit below it is worth all samples, however smooth it is.
pub fn independent_samples(misfit: &[f64], record_rms: f64, most: f64) -> f64 {
    let power = misfit.len() as f64 * visible_misfit(misfit, record_rms).powi(2);
    if power <= 0.0 || !power.is_finite() {
        return most.min(misfit.len() as f64);
    }
    let at_lag = |lag: usize| misfit[lag..].iter().zip(misfit).map(|(a, b)| a * b).sum::<f64>() / power;
    let sum: f64 = (1..misfit.len()).map(at_lag).take_while(|rho| *rho >= UNCORRELATED).sum();
    (misfit.len() as f64 / (1.0 + 2.0 * sum)).min(most)
}

/// Fastest vibration that counts as a motion of the vehicle where the noise is known, Hz: models of a vehicle vibrate
/// at up to 50 Hz, mounts of sensors from 60 Hz on.
const SLOW_HZ: f64 = 60.0;

/// The part of a misfit that is slower than 60 Hz, wave by wave: its first terms of the discrete cosine transform, in
/// which the ends of the window make no difference.
pub fn slow_misfit(observed: &Observation, misfit: &[f64]) -> Vec<f64> {
    let parts = observed.waves.iter().zip(observed.split(misfit));
    parts.flat_map(|(wave, misfit)| slow_part(misfit, wave.measurement.dt_s * wave.stride as f64)).collect()
}

/// The same of one wave with samples `dt_s` apart.
fn slow_part(misfit: &[f64], dt_s: f64) -> Vec<f64> {
    let count = misfit.len();
    let terms = ((2.0 * SLOW_HZ * dt_s * count as f64).round() as usize).clamp(1, count.max(1));
    let mut slow = vec![0.0; count];
    for term in 0..terms.min(count) {
        let angle = PI * term as f64 / count as f64;
        let wave = |k: usize| (angle * (k as f64 + 0.5)).cos();
        let norm = if term == 0 { 1.0 } else { 2.0 } / count as f64;
        let amount = norm * misfit.iter().enumerate().map(|(k, e)| e * wave(k)).sum::<f64>();
        slow.iter_mut().enumerate().for_each(|(k, slow)| *slow += amount * wave(k));
    }
    slow
}

/// Independent samples that a criterion of a candidate with so many free numbers needs, its level of noise counted.
pub fn fewest_samples(parameters: usize) -> f64 {
    (parameters + 1) as f64 + TO_SPARE
}

/// The corrected Akaike criterion of a misfit with so many free numbers, its own level of noise counted as one more.
///
/// `record_rms` is the root mean square of the record. `None`: fewer than two independent samples more than numbers.
pub fn criterion(misfit: &[f64], record_rms: f64, samples: f64, parameters: usize) -> Option<f64> {
    let charged = parameters + 1;
    if misfit.is_empty() || samples < fewest_samples(parameters) {
        return None;
    }
    let loss = visible_misfit(misfit, record_rms).powi(2);
    Some(InformationCriteria::new(loss, samples, charged).aicc).filter(|aicc| aicc.is_finite())
}

/// Akaike's criterion of a misfit where the level of the noise is known, `N V/s² + 2 p`: nothing is estimated from the
/// misfit that a short record would have to be corrected for. `None` where it is not finite.
pub fn criterion_of_known_noise(
    misfit: &[f64],
    record_rms: f64,
    (samples, noise): (f64, f64),
    parameters: usize,
) -> Option<f64> {
    let ratio = visible_misfit(misfit, record_rms) / noise;
    Some(samples * ratio * ratio + 2.0 * parameters as f64).filter(|criterion| criterion.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_misfit_is_worth_few_samples_and_white_noise_as_many_as_pass_the_filter() {
        let slow: Vec<f64> = (0..1000).map(|k| (f64::from(k) * 2.0 * PI / 1000.0).sin()).collect();
        assert!(independent_samples(&slow, 1.0, f64::INFINITY) < 4.0);
        // A tenth of what the sensor knows: rho_1 is below 1/100.
        assert_eq!(independent_samples(&slow, 1e4, f64::INFINITY), 1000.0);
        let signs: Vec<f64> = (0..1000).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert_eq!(independent_samples(&signs, 1.0, f64::INFINITY), 1000.0);
        assert_eq!(independent_samples(&signs, 1.0, 25.0), 25.0);
        assert_eq!(independent_samples(&[0.0; 7], 0.0, 25.0), 7.0);
    }

    #[test]
    fn a_ring_of_120_hz_is_not_in_the_slow_part_and_a_motion_of_20_hz_is() {
        let wave = |hz: f64| (0..750).map(|k| (2.0 * PI * hz * f64::from(k) * 1e-4).sin()).collect::<Vec<f64>>();
        let size = |wave: &[f64]| wave.iter().map(|e| e * e).sum::<f64>().sqrt();
        // 9 terms of 75 ms; what leaks is that of the ends of the window.
        assert!(size(&slow_part(&wave(120.0), 1e-4)) < 0.2 * size(&wave(120.0)));
        assert!(size(&slow_part(&wave(20.0), 1e-4)) > 0.99 * size(&wave(20.0)));
        // All terms are the misfit itself.
        let all = slow_part(&[1.0, -2.0, 0.5], 1.0);
        assert!(all.iter().zip([1.0, -2.0, 0.5]).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn as_many_numbers_as_samples_have_no_criterion() {
        let misfit = vec![1.0; 100];
        assert_eq!(criterion(&misfit, 100.0, 9.0, 7), None);
        // 10 ln(1 + 0.01) + 2 2 + 2 2 3/(10 - 2 - 1).
        let by_hand = 10.0 * 1.01_f64.ln() + 4.0 + 12.0 / 7.0;
        assert!((criterion(&misfit, 100.0, 10.0, 1).unwrap() - by_hand).abs() < 1e-12);
    }
}

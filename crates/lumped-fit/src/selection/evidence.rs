//! How much a record says for one model over another: the corrected Akaike criterion of misfits as measured, less what
//! a shift of time zero explains of them.
//!
//! A trigger is up to 0.1 ms off and a causal anti-alias filter delays by 0.25 ms (4 poles at 1650 Hz). Every model
//! misses a record that is shifted, and one with more numbers follows the shift: evidence for nothing. So a shift is a
//! number that all candidates may fit.

use std::f64::consts::PI;

use crumple_lumped::Model;
use crumple_numerics::estimation::statistics::InformationCriteria;
use nalgebra::{DMatrix, DVector};

use crate::record::observation::Observation;

/// Largest shift of time zero, s: the uncertainty of time zero that the default pipeline states.
const LARGEST_SHIFT_S: f64 = 5e-4;
/// Relative step of a difference quotient: rounding over it and its second-order error are both below 1e-5.
const DIFFERENCE: f64 = 1e-5;
/// Largest relative change of a number in one step.
const LARGEST_STEP: f64 = 0.3;
/// Steps at most. A fit to the displacement is near: two are enough for most.
const STEPS: usize = 6;
/// A step that lowers the sum of squares by less of it is the last.
const WORTH_A_STEP: f64 = 1e-3;
/// Singular values below this share of the largest are directions that the record does not see.
const SEEN: f64 = 1e-6;

/// A misfit of accelerations (model less record at every sample of all waves) less what a shift of time zero by at most
/// 0.5 ms explains of it, to first order in the shift.
pub fn without_shift(observed: &Observation, misfit: &[f64]) -> Vec<f64> {
    let slope = slope(observed, misfit);
    let shift = dot(misfit, &slope) / dot(&slope, &slope);
    shifted(misfit, &slope, if shift.is_finite() { shift } else { 0.0 })
}

/// The least of [`without_shift`] over the free numbers of a model, of a candidate near it: Gauss-Newton steps in the
/// logarithms of the numbers, the shift beside them, from the model `start`. Numbers that are zero stay.
///
/// `None` where the model has no finite response at the start.
pub fn least_without_shift(observed: &Observation, start: &Model, free: &[&str]) -> Option<Vec<f64>> {
    let raw_at = |values: &[f64]| observed.misfit_of(&start.with_values(values).ok()?.structure().ok()?);
    let (names, mut values) = (start.names(), start.values());
    let mut raw = raw_at(&values)?;
    let mut least = without_shift(observed, &raw);
    let places = free.iter().filter_map(|free| names.iter().position(|name| name == free));
    let free: Vec<usize> = places.filter(|k| values[*k] != 0.0).collect();
    for _ in 0..STEPS {
        let mut columns = Vec::with_capacity(free.len() + 1);
        for k in &free {
            let mut moved = values.clone();
            moved[*k] *= 1.0 + DIFFERENCE;
            let Some(moved) = raw_at(&moved) else { return Some(least) };
            columns.push(DVector::from_iterator(raw.len(), moved.iter().zip(&raw).map(|(m, r)| (m - r) / DIFFERENCE)));
        }
        columns.push(DVector::from_vec(slope(observed, &raw)));
        let svd = DMatrix::from_columns(&columns).svd(true, true);
        let tolerance = SEEN * svd.singular_values.max();
        let Ok(step) = svd.solve(&DVector::from_column_slice(&raw), tolerance) else { return Some(least) };
        let largest = step.iter().take(free.len()).fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let share = if largest > LARGEST_STEP { LARGEST_STEP / largest } else { 1.0 };
        for (k, x) in free.iter().zip(step.iter()) {
            values[*k] *= (-share * x).exp();
        }
        let Some(there) = raw_at(&values) else { return Some(least) };
        let lower = without_shift(observed, &there);
        let (before, after) = (dot(&least, &least), dot(&lower, &lower));
        if after.is_nan() || after >= before {
            return Some(least);
        }
        (raw, least) = (there, lower);
        if before - after < WORTH_A_STEP * before {
            break;
        }
    }
    Some(least)
}

/// The slopes of the modelled waves times their weights, per second: central differences, at the ends those of the
/// neighbours.
fn slope(observed: &Observation, misfit: &[f64]) -> Vec<f64> {
    let mut slopes = Vec::with_capacity(misfit.len());
    for (wave, misfit) in observed.waves.iter().zip(observed.split(misfit)) {
        let spacing_s = wave.measurement.dt_s * wave.stride as f64;
        let record = wave.samples.iter().map(|record| record * wave.weight);
        let model: Vec<f64> = record.zip(misfit).map(|(record, misfit)| record + misfit).collect();
        let last = model.len().saturating_sub(1);
        slopes.extend((0..model.len()).map(|k| {
            let (from, to) = (k.saturating_sub(1), (k + 1).min(last));
            (model[to] - model[from]) / ((to - from).max(1) as f64 * spacing_s)
        }));
    }
    slopes
}

fn shifted(misfit: &[f64], slope: &[f64], shift_s: f64) -> Vec<f64> {
    let shift_s = shift_s.clamp(-LARGEST_SHIFT_S, LARGEST_SHIFT_S);
    misfit.iter().zip(slope).map(|(misfit, slope)| misfit - shift_s * slope).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

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
    use crate::FitQuantity;
    use crate::record::observation::ObservedWave;
    use crumple_lumped::{Kelvin, Model};
    use crumple_signal::Measurement;
    use crumple_signal::Sampled;

    const KELVIN: Kelvin = Kelvin { mass_kg: 1000.0, stiffness_n_per_m: 4e5, damping_n_s_per_m: 8e3 };
    const SPEED: f64 = 15.0;

    /// The acceleration of the model, late by `shift_s`, from 5 to 60 ms.
    fn late_by(shift_s: f64) -> Observation {
        let at = |k: u32| KELVIN.state(SPEED, (f64::from(k) * 1e-4 - shift_s).max(0.0)).acceleration_m_per_s2;
        let record = Sampled::new(0.0, 1e-4, (0..800).map(at).collect()).unwrap();
        let (what, measurement) = ((None, FitQuantity::Acceleration), Measurement::of_samples(&record));
        let wave = ObservedWave::new(&record, what, measurement, (0.005, 0.06), usize::MAX).unwrap();
        Observation { impact_speed_m_per_s: SPEED, waves: vec![wave] }
    }

    fn size(misfit: &[f64]) -> f64 {
        dot(misfit, misfit).sqrt()
    }

    #[test]
    fn a_small_shift_is_no_misfit_and_a_large_one_is() {
        let ratio = |shift_s: f64| {
            let observed = late_by(shift_s);
            let misfit = observed.misfit(&Model::Kelvin(KELVIN)).unwrap();
            size(&without_shift(&observed, &misfit)) / size(&misfit)
        };
        // Half of the shift times the circular frequency of 20 per second is left: the second order.
        assert!(ratio(3e-4) < 0.01 && ratio(-3e-4) < 0.01, "{} {}", ratio(3e-4), ratio(-3e-4));
        // Of 1 ms half may be taken off.
        assert!((ratio(1e-3) - 0.5).abs() < 0.02, "{}", ratio(1e-3));
    }

    #[test]
    fn the_least_misfit_is_found_from_numbers_that_followed_the_shift() {
        let observed = late_by(3e-4);
        let start = Model::Kelvin(Kelvin { stiffness_n_per_m: 4.2e5, damping_n_s_per_m: 7e3, ..KELVIN });
        let misfit = |free: &[&str]| size(&least_without_shift(&observed, &start, free).unwrap());
        let fixed = misfit(&[]);
        assert!(misfit(&["stiffness_n_per_m", "damping_n_s_per_m"]) < 0.01 * fixed);
        assert!(misfit(&["stiffness_n_per_m"]) > 0.1 * fixed);
    }

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

//! Misfits of an acceleration whose time zero is not known to a fraction of a millisecond.
//!
//! A trigger is up to 0.1 ms off and a causal anti-alias filter delays by 0.25 ms (4 poles at 1650 Hz). Every model
//! misses a record that is shifted, and one with more numbers follows the shift: evidence for nothing. So a shift is a
//! number that all candidates may fit.

use std::collections::BTreeMap;

use crumple_lumped::structure_of;
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
/// logarithms of the numbers, the shift beside them, from the numbers in `start`. Numbers that are zero stay.
///
/// `None` where the model has no finite response at the start.
pub fn least_without_shift(
    observed: &Observation,
    (model, start): (&str, &BTreeMap<String, f64>),
    free: &[&str],
) -> Option<Vec<f64>> {
    let raw_at = |parameters: &BTreeMap<String, f64>| observed.misfit_of(&structure_of(model, parameters).ok()?);
    let mut parameters = start.clone();
    let mut raw = raw_at(&parameters)?;
    let mut least = without_shift(observed, &raw);
    let free: Vec<&str> = free.iter().copied().filter(|name| start.get(*name).is_some_and(|x| *x != 0.0)).collect();
    for _ in 0..STEPS {
        let mut columns = Vec::with_capacity(free.len() + 1);
        for name in &free {
            let mut moved = parameters.clone();
            *moved.get_mut(*name)? *= 1.0 + DIFFERENCE;
            let Some(moved) = raw_at(&moved) else { return Some(least) };
            columns.push(DVector::from_iterator(raw.len(), moved.iter().zip(&raw).map(|(m, r)| (m - r) / DIFFERENCE)));
        }
        columns.push(DVector::from_vec(slope(observed, &raw)));
        let svd = DMatrix::from_columns(&columns).svd(true, true);
        let tolerance = SEEN * svd.singular_values.max();
        let Ok(step) = svd.solve(&DVector::from_column_slice(&raw), tolerance) else { return Some(least) };
        let largest = step.iter().take(free.len()).fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let share = if largest > LARGEST_STEP { LARGEST_STEP / largest } else { 1.0 };
        for (name, x) in free.iter().zip(step.iter()) {
            *parameters.get_mut(*name)? *= (-share * x).exp();
        }
        let Some(there) = raw_at(&parameters) else { return Some(least) };
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

#[cfg(test)]
mod tests {
    use crumple_lumped::{Kelvin, Model};
    use crumple_signal::Sampled;

    use super::*;
    use crate::FitQuantity;
    use crate::record::observation::ObservedWave;
    use crumple_signal::Measurement;

    const KELVIN: Kelvin = Kelvin { mass_kg: 1000.0, stiffness_n_per_m: 4e5, damping_n_s_per_m: 8e3 };
    const SPEED: f64 = 15.0;

    /// The acceleration of the model, late by `shift_s`, from 5 to 60 ms.
    fn late_by(shift_s: f64) -> Observation {
        let at = |k: u32| KELVIN.state(SPEED, (f64::from(k) * 1e-4 - shift_s).max(0.0)).acceleration_m_per_s2;
        let record = Sampled::new(0.0, 1e-4, (0..800).map(at).collect()).unwrap();
        let (what, measurement) = ((None, FitQuantity::Acceleration), Measurement::of_samples(&record, 0.0));
        let wave = ObservedWave::new(&record, what, 0.0, measurement, (0.005, 0.06), usize::MAX).unwrap();
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
        let start: BTreeMap<String, f64> =
            [("mass_kg", 1000.0), ("stiffness_n_per_m", 4.2e5), ("damping_n_s_per_m", 7e3)]
                .map(|(name, value)| (name.to_owned(), value))
                .into();
        let misfit = |free: &[&str]| size(&least_without_shift(&observed, ("kelvin", &start), free).unwrap());
        let fixed = misfit(&[]);
        assert!(misfit(&["stiffness_n_per_m", "damping_n_s_per_m"]) < 0.01 * fixed);
        assert!(misfit(&["stiffness_n_per_m"]) > 0.1 * fixed);
    }
}

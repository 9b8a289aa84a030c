//! How much a record says for one model over another: how well each predicts the record, before its numbers are fitted
//! to it.
//!
//! The evidence is the slow part of the acceleration, below 60 Hz, as its terms of the discrete cosine transform. What
//! a model says of them is Gaussian: its numbers are known to a factor of 2 beforehand, time zero to its uncertainty,
//! and what no lumped model of a vehicle describes is one discrepancy, the same for all. The density of all terms under
//! that is the product of the densities of each stretch of the record given those before it (A. P. Dawid, *The
//! prequential approach*, J. R. Statist. Soc. A 147, 1984): every stretch is scored by what a model predicts of it
//! without having been fitted to it, so that a number is worth what it foretells. The discrepancy is that of M. C.
//! Kennedy & A. O'Hagan, *Bayesian calibration of computer models*, J. R. Statist. Soc. B 63, 2001.

use std::f64::consts::{LN_2, PI};

use crumple_lumped::{Model, Place};
use nalgebra::{Cholesky, DMatrix, DVector};

use crate::record::observation::{Observation, ObservedWave};
use crate::uncertainty::uncertain_inputs::TIME_ZERO_S;

/// Standard deviation of the logarithm of a number before the record: a factor of 2, the range of vehicles.
const BEFORE_THE_RECORD: f64 = LN_2;
/// What each number is charged beforehand, beside what the score charges it for what it foretells: one more halves the
/// odds of a model, so that of models which the record does not tell apart the simpler one is taken.
pub const OF_A_NUMBER: f64 = 2.0 * LN_2;
/// Largest relative change of a number in one step towards the least misfit.
const LARGEST_STEP: f64 = 0.3;
/// Steps at most: fits to the displacement are near.
const STEPS: usize = 2;
/// Fastest vibration that counts as a motion of the vehicle, Hz: models of a vehicle vibrate at up to 50 Hz, mounts of
/// sensors from 60 Hz on.
pub const SLOW_HZ: f64 = 60.0;

/// What a record says of one candidate, linear about its numbers: the slow terms of model less record, and what each
/// number, in its logarithm and in standard deviations beforehand, and time zero change of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// The slow terms of the misfit, unit of the record times the root of a second, so that a wave with twice the
    /// samples has the same.
    pub terms: DVector<f64>,
    /// A column a number, behind them that of the time zero of each record.
    pub sensitivity: DMatrix<f64>,
    /// Names of the numbers.
    pub names: Vec<String>,
}

impl Evidence {
    /// Of a candidate with these free numbers, near the least misfit to all records, each with what it is divided by.
    /// Numbers that are zero stay. `None` where the model has no finite response.
    pub fn new(records: &[(Observation, f64)], start: &Model, free: &[&str]) -> Option<Self> {
        let slow: Vec<SlowTerms> = records.iter().map(|(observed, _)| SlowTerms::of(observed)).collect();
        let terms_of_all = |misfits: &[Vec<f64>]| terms_of_all(records, &slow, misfits);
        let terms_at = |values: &[f64]| {
            let structure = start.with_values(values).ok()?.structure().ok()?;
            let misfits = records.iter().map(|(observed, _)| observed.misfit_of(&structure));
            let misfits: Vec<Vec<f64>> = misfits.collect::<Option<_>>()?;
            Some((terms_of_all(&misfits), misfits))
        };
        let (names, mut values) = (start.names(), start.values());
        let indices = free.iter().filter_map(|free| names.iter().position(|name| name == free));
        let free: Vec<usize> = indices.filter(|k| values[*k] != 0.0).collect();
        let places: Vec<Place> = free.iter().map(|k| start.places()[*k]).collect();
        let at = |values: &[f64], (terms, misfits): (DVector<f64>, Vec<Vec<f64>>)| -> Option<Self> {
            let mut columns = Vec::with_capacity(free.len() + records.len());
            let structure = start.with_values(values).ok()?.structure().ok()?;
            let by_places = records.iter().map(|(observed, _)| observed.derivatives_of(&structure, &places, false));
            let by_places: Vec<Vec<Vec<f64>>> = by_places.collect::<Option<_>>()?;
            for (number, k) in free.iter().enumerate() {
                let of_number: Vec<Vec<f64>> = by_places.iter().map(|of_record| of_record[number].clone()).collect();
                columns.push(terms_of_all(&of_number) * (values[*k] * BEFORE_THE_RECORD));
            }
            // Each record has a time zero of its own.
            for record in 0..records.len() {
                let slopes = records.iter().zip(&misfits).enumerate().map(|(k, ((observed, _), misfit))| {
                    if k == record { slope(observed, misfit) } else { vec![0.0; misfit.len()] }
                });
                columns.push(terms_of_all(&slopes.collect::<Vec<_>>()) * TIME_ZERO_S);
            }
            let names = free.iter().map(|k| names[*k].to_string()).collect();
            Some(Self { terms, sensitivity: DMatrix::from_columns(&columns), names })
        };
        let mut here = at(&values, terms_at(&values)?)?;
        for _ in 1..STEPS {
            let step = here.least_step(here.terms.norm_squared() / here.terms.len() as f64)?;
            let largest = step.iter().take(free.len()).fold(0.0_f64, |largest, x| largest.max(x.abs()));
            let share = (LARGEST_STEP / BEFORE_THE_RECORD / largest).min(1.0);
            let mut there = values.clone();
            for (k, x) in free.iter().zip(step.iter()) {
                there[*k] *= (share * x * BEFORE_THE_RECORD).exp();
            }
            let Some(found) = terms_at(&there).filter(|(terms, _)| terms.norm() < here.terms.norm()) else { break };
            here = at(&there, found)?;
            values = there;
        }
        Some(here)
    }

    /// The step, in standard deviations beforehand, to the largest density where each term is known to this variance.
    fn least_step(&self, variance: f64) -> Option<DVector<f64>> {
        let normal = self.sensitivity.tr_mul(&self.sensitivity) / variance;
        let count = normal.nrows();
        let right = self.sensitivity.tr_mul(&self.terms) / -variance;
        Some(Cholesky::new(normal + DMatrix::identity(count, count))?.solve(&right))
    }

    /// Mean square of a term at the least misfit over what is left after as many numbers; `None`: none is left.
    pub fn least_variance(&self) -> Option<f64> {
        let count = self.terms.len();
        let left = count.checked_sub(self.sensitivity.ncols()).filter(|left| *left > 0)?;
        let step = self.least_step(self.terms.norm_squared() / count as f64)?;
        Some((&self.terms + &self.sensitivity * step).norm_squared() / left as f64)
    }

    /// Standard deviations of the logarithms of the numbers, once the terms are known, each of them to this variance.
    pub fn deviations(&self, variance: f64) -> Vec<(String, f64)> {
        let count = self.sensitivity.ncols();
        let normal = self.sensitivity.tr_mul(&self.sensitivity) / variance + DMatrix::identity(count, count);
        let Some(covariance) = Cholesky::new(normal).map(|root| root.inverse()) else { return Vec::new() };
        let of = |k: usize| BEFORE_THE_RECORD * covariance[(k, k)].sqrt();
        self.names.iter().enumerate().map(|(k, name)| (name.clone(), of(k))).collect()
    }

    /// Minus twice the logarithm of the density of the terms, each of which no model knows better than to this
    /// variance, less what all candidates share.
    pub fn score(&self, variance: f64) -> Option<f64> {
        let count = self.sensitivity.ncols();
        let normal = self.sensitivity.tr_mul(&self.sensitivity) / variance + DMatrix::identity(count, count);
        let root = Cholesky::new(normal)?;
        let right = self.sensitivity.tr_mul(&self.terms) / variance;
        let explained = right.dot(&root.solve(&right));
        let volume: f64 = root.l().diagonal().iter().map(|x| 2.0 * x.ln()).sum();
        Some(self.terms.norm_squared() / variance - explained + volume).filter(|score| score.is_finite())
    }
}

/// The slow terms of misfits to records side by side, each divided by its unit.
fn terms_of_all(records: &[(Observation, f64)], slow: &[SlowTerms], misfits: &[Vec<f64>]) -> DVector<f64> {
    let each = records.iter().zip(slow).zip(misfits);
    let terms =
        each.flat_map(|(((observed, unit), slow), misfit)| slow.of_misfit(observed, misfit).map(move |x| x / unit));
    DVector::from_iterator(slow.iter().map(SlowTerms::count).sum(), terms)
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

/// What is slower than 60 Hz in misfits to a record, wave by wave: their first terms of the orthonormal discrete
/// cosine transform, in which the ends of the window make no difference, times the root of the sampling interval.
struct SlowTerms(Vec<Vec<SlowTerm>>);

/// A term: its norm, and its cosine at every sample.
struct SlowTerm {
    norm: f64,
    cosines: Vec<f64>,
}

impl SlowTerms {
    fn of(observed: &Observation) -> Self {
        let of_wave = |wave: &ObservedWave| slow_terms(wave.samples.len(), wave.measurement.dt_s * wave.stride as f64);
        Self(observed.waves.iter().map(of_wave).collect())
    }

    fn count(&self) -> usize {
        self.0.iter().map(Vec::len).sum()
    }

    fn of_misfit(&self, observed: &Observation, misfit: &[f64]) -> impl Iterator<Item = f64> {
        let parts = self.0.iter().zip(observed.split(misfit));
        parts.flat_map(|(terms, misfit)| terms.iter().map(move |term| term.of(misfit)))
    }
}

impl SlowTerm {
    fn of(&self, misfit: &[f64]) -> f64 {
        self.norm * misfit.iter().zip(&self.cosines).map(|(e, cosine)| e * cosine).sum::<f64>()
    }
}

/// The slow terms of one wave of so many samples, `dt_s` apart.
fn slow_terms(count: usize, dt_s: f64) -> Vec<SlowTerm> {
    let terms = ((2.0 * SLOW_HZ * dt_s * count as f64).round() as usize).clamp(1, count.max(1));
    let term = |term: usize| {
        let angle = PI * term as f64 / count as f64;
        let norm = (if term == 0 { dt_s } else { 2.0 * dt_s } / count as f64).sqrt();
        SlowTerm { norm, cosines: (0..count).map(|k| (angle * (k as f64 + 0.5)).cos()).collect() }
    };
    (0..terms).map(term).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::sensor::FitQuantity;
    use crumple_lumped::{Kelvin, Model};
    use crumple_signal::{Measurement, Sampled};

    const KELVIN: Kelvin = Kelvin { mass_kg: 1000.0, stiffness_n_per_m: 4e5, damping_n_s_per_m: 8e3 };
    const SPEED: f64 = 15.0;
    const FREE: [&str; 2] = ["stiffness_n_per_m", "damping_n_s_per_m"];

    /// The acceleration of the model, late by `shift_s`, from 5 to 60 ms.
    fn late_by(shift_s: f64) -> Observation {
        let at = |k: u32| KELVIN.state(SPEED, (f64::from(k) * 1e-4 - shift_s).max(0.0)).acceleration_m_per_s2;
        let record = Sampled::new(0.0, 1e-4, (0..800).map(at).collect()).unwrap();
        let (what, measurement) = ((None, FitQuantity::Acceleration), Measurement::of_samples(&record));
        let wave = ObservedWave::new(&record, what, measurement, (0.005, 0.06), usize::MAX).unwrap();
        Observation { impact_speed_m_per_s: SPEED, waves: vec![wave] }
    }

    /// Variance of a term where the record is known to this share.
    fn variance(observed: &Observation, share: f64) -> f64 {
        (share * observed.waves[0].size()).powi(2) / (2.0 * SLOW_HZ)
    }

    #[test]
    fn the_score_is_the_product_of_what_each_stretch_is_predicted_by_those_before_it() {
        let observed = late_by(2e-4);
        let evidence = Evidence::new(&[(observed.clone(), 1.0)], &Model::Kelvin(KELVIN), &FREE).unwrap();
        let known = variance(&observed, 0.02);
        // One term after the other: mean and variance given those before it, then the numbers given it as well.
        let count = evidence.sensitivity.ncols();
        let (mut mean, mut spread): (DVector<f64>, DMatrix<f64>) =
            (DVector::zeros(count), DMatrix::identity(count, count));
        let mut sum = 0.0;
        for (term, row) in evidence.terms.iter().zip(evidence.sensitivity.row_iter()) {
            let row: DVector<f64> = row.transpose();
            let of_term: DVector<f64> = &spread * &row;
            let (error, variance) = (-term - row.dot(&mean), known + row.dot(&of_term));
            sum += error * error / variance + (variance / known).ln();
            mean += &of_term * (error / variance);
            spread -= &of_term * of_term.transpose() / variance;
        }
        let score = evidence.score(known).unwrap();
        assert!((score - sum).abs() < 1e-9 * sum, "{score} {sum}");
    }

    #[test]
    fn what_the_record_determines_is_known_better_than_to_a_factor_of_2() {
        let observed = late_by(0.0);
        let known = |share: f64| {
            let evidence = Evidence::new(&[(observed.clone(), 1.0)], &Model::Kelvin(KELVIN), &FREE).unwrap();
            evidence.deviations(variance(&observed, share))
        };
        let (fine, coarse) = (known(0.02), known(100.0));
        assert!(fine.iter().zip(FREE).all(|((name, deviation), free)| name == free && *deviation < 0.2), "{fine:?}");
        // Of a record that says nothing what was known before is left.
        assert!(coarse.iter().all(|(_, deviation)| (deviation / LN_2 - 1.0).abs() < 1e-2), "{coarse:?}");
    }

    #[test]
    fn a_shift_of_time_zero_is_no_reason_and_a_wrong_spring_is_one() {
        let score = |shift_s: f64, k: f64, free: &[&str]| {
            let (observed, model) = (late_by(shift_s), Kelvin { stiffness_n_per_m: k, ..KELVIN });
            let known = variance(&observed, 0.02);
            Evidence::new(&[(observed, 1.0)], &Model::Kelvin(model), free).unwrap().score(known).unwrap()
        };
        // The shift is within one deviation, which costs 1 at most beside what is second order.
        assert!(score(2e-4, 4e5, &[]) - score(0.0, 4e5, &[]) < 1.0);
        assert!(score(0.0, 5e5, &[]) - score(0.0, 4e5, &[]) > 10.0);
        // A number that is free is brought to its least misfit.
        assert!((score(0.0, 4.4e5, &FREE) - score(0.0, 4e5, &FREE)).abs() < 0.5);
    }

    #[test]
    fn two_records_of_one_vehicle_are_linear_about_one_set_of_numbers() {
        // A fit between two records of springs 20 % apart: steps to the least misfit of each would go apart.
        let of = |stiffness_n_per_m: f64| {
            let car = Kelvin { stiffness_n_per_m, ..KELVIN };
            let at = |k: u32| car.state(SPEED, f64::from(k) * 1e-4).acceleration_m_per_s2;
            let record = Sampled::new(0.0, 1e-4, (0..800).map(at).collect()).unwrap();
            let (what, measurement) = ((None, FitQuantity::Acceleration), Measurement::of_samples(&record));
            let wave = ObservedWave::new(&record, what, measurement, (0.005, 0.06), usize::MAX).unwrap();
            Observation { impact_speed_m_per_s: SPEED, waves: vec![wave] }
        };
        let model = Model::Kelvin(Kelvin { stiffness_n_per_m: 4.4e5, ..KELVIN });
        let (soft, stiff) = (of(4e5), of(4.8e5));
        let alone = |observed: &Observation| Evidence::new(&[(observed.clone(), 1.0)], &model, &FREE).unwrap();
        let (a, b) = (alone(&soft), alone(&stiff));
        let both = Evidence::new(&[(soft, 1.0), (stiff, 2.0)], &model, &FREE).unwrap();
        let count = a.terms.len();
        assert_eq!((both.terms.len(), both.sensitivity.ncols()), (2 * count, FREE.len() + 2));
        // Each alone is brought to its own spring, both together to neither.
        assert!(a.terms.norm() < 0.1 * both.terms.rows(0, count).norm());
        assert!(b.terms.norm() < 0.1 * 2.0 * both.terms.rows(count, count).norm());
        // The time zero of one record changes nothing of the other.
        assert_eq!(both.sensitivity.column(FREE.len()).rows(count, count).norm(), 0.0);
        assert_eq!(both.sensitivity.column(FREE.len() + 1).rows(0, count).norm(), 0.0);
    }

    #[test]
    fn a_ring_of_120_hz_is_not_in_the_slow_terms_and_a_motion_of_20_hz_is() {
        let wave = |hz: f64| (0..750).map(|k| (2.0 * PI * hz * f64::from(k) * 1e-4).sin()).collect::<Vec<f64>>();
        let size = |wave: &[f64]| wave.iter().map(|e| e * e).sum::<f64>().sqrt();
        let slow_part = |misfit: &[f64], dt_s: f64| -> Vec<f64> {
            slow_terms(misfit.len(), dt_s).iter().map(|term| term.of(misfit)).collect()
        };
        let of_terms = |misfit: &[f64], dt_s: f64| size(&slow_part(misfit, dt_s)) / dt_s.sqrt();
        // 9 terms of 75 ms; what leaks is that of the ends of the window.
        assert!(of_terms(&wave(120.0), 1e-4) < 0.2 * size(&wave(120.0)));
        assert!(of_terms(&wave(20.0), 1e-4) > 0.99 * size(&wave(20.0)));
        // All terms have the size of the misfit itself.
        assert!((of_terms(&[1.0, -2.0, 0.5], 1.0) - size(&[1.0, -2.0, 0.5])).abs() < 1e-12);
        // Twice the samples of a slow motion have the terms of the half.
        let twice: Vec<f64> = (0..1500).map(|k| (2.0 * PI * 20.0 * (f64::from(k) - 0.5) * 5e-5).sin()).collect();
        let (fine, coarse) = (slow_part(&twice, 5e-5), slow_part(&wave(20.0), 1e-4));
        assert_eq!(fine.len(), coarse.len());
        assert!(fine.iter().zip(&coarse).all(|(a, b)| (a - b).abs() < 1e-2 * size(&coarse)), "{fine:?} {coarse:?}");
    }
}

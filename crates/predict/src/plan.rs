//! Which second test would make a predicted crush surer, and by how much.
//!
//! What a second test would measure is taken from the model: its expected interval is that of a prediction with the
//! covariance of the parameters after both tests, the speeds of both, and the models that the second would leave. The
//! sensitivities of a displacement `J` (rows are instants, columns logarithms of parameters) and the covariance `C` of
//! the first test say how good a record is: its variance `s` is the largest eigenvalue of `J₁ C J₁ᵀ`, so that the same
//! test again halves the variance of what moves the record most. After the second the covariance is
//! `C - C J₂ᵀ (J₂ C J₂ᵀ + s)⁻¹ J₂ C`, the linear update of Bayes' rule: K. Chaloner and I. Verdinelli, *Bayesian
//! Experimental Design: A Review*, Statistical Science 10, 1995.

use crumple_lumped::{Instants, Structure};
use nalgebra::{DMatrix, SymmetricEigen};
use rayon::prelude::*;

use crate::error::PredictError;
use crate::impact::candidate::{Candidate, ImpactSetup, ParameterSpread, Scenario, TestedImpact};
use crate::impact::outcome::Quantity;
use crate::intervals::sources::Inputs;
use crate::intervals::tested::log_covariance;
use crate::predict::predict;

/// A second test of the vehicle that could be made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondTest {
    /// Its impact speed, m/s.
    pub speed_m_per_s: f64,
    /// Mass of the vehicle in it, kg; `None`: that of the first test.
    pub mass_kg: Option<f64>,
    /// Whether a sensor is on each mass of the model too, and not on the compartment alone.
    pub sees_every_mass: bool,
}

/// Instants of a record that are compared: its displacement is smooth, and more carry no more.
const INSTANTS: usize = 30;
/// How long a test is followed, s: crashes stop before.
const LENGTH_S: f64 = 0.12;
/// Relative step of a parameter for a derivative: the error of a central difference is its square.
const STEP: f64 = 1e-4;
/// How far a model is trusted in a test that it was not fitted to, as a share of the crush: the deviation of plastic
/// models at lower speeds that the choice of candidates uses.
const MODEL_DEVIATION: f64 = 0.01;

/// Widths of the 90 % interval of the crush in an impact, m: now, and expected after each second test (`None`: the
/// model has no motion there). The recommended candidate is at `place`. Errors: no motion in the impact asked for.
pub fn expected_widths(
    candidates: &[Candidate],
    place: usize,
    test: &TestedImpact,
    inputs: Inputs,
    wanted: Scenario,
    second: &[SecondTest],
) -> Result<(f64, Vec<Option<f64>>), PredictError> {
    let width = |candidates: &[Candidate], test: &TestedImpact| -> Result<Option<f64>, PredictError> {
        let all = predict(candidates, &[place], test, inputs, &[wanted], &ImpactSetup::default());
        let Some(prediction) = all.into_iter().flatten().next() else { return Ok(None) };
        let prediction = prediction?;
        let interval = &prediction.intervals[Quantity::DynamicCrush as usize];
        Ok(interval.as_ref().map(|interval| interval.high - interval.low))
    };
    let now = width(candidates, test)?.ok_or(PredictError::NoInterval)?;
    let after = |second: &SecondTest| {
        let crushes = crushes(candidates, second);
        let own = crushes[place]?;
        // As sure as the first test was of its own crush, in proportion to the speed.
        let by_inputs = test.crush_deviation_m * second.speed_m_per_s / test.speed_m_per_s;
        let deviation = by_inputs.hypot(MODEL_DEVIATION * own);
        let mut left = candidates.to_vec();
        for (candidate, crush) in left.iter_mut().zip(&crushes) {
            let off = crush.map_or(f64::INFINITY, |crush| (crush - own) / deviation);
            candidate.weight *= (-0.5 * off * off).exp();
        }
        left[place].spread = updated(&candidates[place], test, second).or(left[place].spread.take());
        // A test that makes nothing surer can be left out of account.
        Some(width(&left, &with_second(test, second, wanted)).ok()??.min(now))
    };
    Ok((now, second.par_iter().map(after).collect()))
}

/// The crush of every candidate in a test, m.
fn crushes(candidates: &[Candidate], second: &SecondTest) -> Vec<Option<f64>> {
    let crush = |candidate: &Candidate| {
        let structure = candidate.structure(second.mass_kg).ok()?;
        structure.dynamic_crush_m(second.speed_m_per_s, crumple_lumped::HORIZON_S).ok()?
    };
    candidates.par_iter().map(crush).collect()
}

/// The tests of the vehicle, of which the one counts that reaches the impact asked for, and is nearest to it.
fn with_second(test: &TestedImpact, second: &SecondTest, wanted: Scenario) -> TestedImpact {
    let reach = |speed: f64| speed >= wanted.speed_m_per_s * (1.0 - 1e-9);
    let (first, other) = (test.speed_m_per_s, second.speed_m_per_s);
    let takes_second = match (reach(first), reach(other)) {
        (true, true) => other < first,
        (false, false) => other > first,
        (_, second_reaches) => second_reaches,
    };
    if !takes_second {
        let range_m_per_s = (test.range_m_per_s.0.min(other), test.range_m_per_s.1.max(other));
        return TestedImpact { range_m_per_s, ..test.clone() };
    }
    let (slowest, fastest) = test.range_m_per_s;
    TestedImpact::new(other, [slowest, fastest]).with_crush_deviation(test.crush_deviation_m * other / first)
}

/// The spread of the parameters after both tests; `None` where nothing is known of it, or nothing moves.
fn updated(candidate: &Candidate, test: &TestedImpact, second: &SecondTest) -> Option<ParameterSpread> {
    let spread = candidate.spread.as_ref()?;
    let (names, covariance) = log_covariance(candidate)?;
    let first = SecondTest { speed_m_per_s: test.speed_m_per_s, mass_kg: None, sees_every_mass: false };
    let [first, second] = [&first, second].map(|test| sensitivities(candidate, &names, test));
    let (first, second) = (first?, second?);
    let of_first = &first * &covariance * first.transpose();
    if of_first.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    let noise = SymmetricEigen::new(of_first).eigenvalues.max();
    if noise <= 0.0 {
        return None;
    }
    let across = &covariance * second.transpose();
    let seen = &second * &across + DMatrix::identity(second.nrows(), second.nrows()) * noise;
    let left = &covariance - &across * seen.cholesky()?.solve(&across.transpose());
    let deviations: Vec<f64> = (0..names.len()).map(|i| left[(i, i)].max(0.0).sqrt()).collect();
    let mut updated = spread.clone();
    for (name, deviation) in names.iter().zip(&deviations) {
        updated.standard_deviation.insert(name.clone(), deviation * candidate.value(name)?.abs());
    }
    updated.order.clone_from(&names);
    let correlation = |i: usize, j: usize| match deviations[i] * deviations[j] {
        _ if i == j => 1.0,
        0.0 => 0.0,
        size => left[(i, j)] / size,
    };
    updated.correlation = (0..names.len()).map(|i| (0..names.len()).map(|j| correlation(i, j)).collect()).collect();
    Some(updated)
}

/// Derivatives of the displacements of a test by the logarithms of these parameters, m; rows are instants.
fn sensitivities(candidate: &Candidate, names: &[String], test: &SecondTest) -> Option<DMatrix<f64>> {
    let at = Instants { first_s: 0.0, dt_s: LENGTH_S / INSTANTS as f64, samples: INSTANTS };
    let displacements = |structure: &Structure| -> Option<Vec<f64>> {
        let motions = structure.motions_at(test.speed_m_per_s, &at).ok()?;
        let seen = if test.sees_every_mass { 0 } else { motions.len() - 1 };
        Some(motions[seen..].iter().flat_map(|motion| motion.displacement_m.clone()).collect())
    };
    let column = |name: &String| {
        let moved = |step: f64| {
            let factors = [(name.clone(), f64::exp(step))].into();
            displacements(&candidate.changed(&factors, test.mass_kg)?)
        };
        let (up, down) = (moved(STEP)?, moved(-STEP)?);
        Some(up.iter().zip(&down).map(|(up, down)| (up - down) / (2.0 * STEP)).collect::<Vec<f64>>())
    };
    let columns: Vec<Vec<f64>> = names.iter().map(column).collect::<Option<_>>()?;
    let rows = columns.first()?.len();
    Some(DMatrix::from_fn(rows, columns.len(), |i, j| columns[j][i]))
}

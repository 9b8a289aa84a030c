//! Weights of adequate models, and a partner with its own.

use std::collections::BTreeMap;

use crumple_lumped_fit::EnergyClass;

use crate::error::PredictError;
use crate::impact::candidate::{Candidate, Partner, Scenario};
use crate::impact::partner::Opponent;
use crate::intervals::tested::{OwnTest, Tested};

/// Models that count at most.
const MOST: usize = 5;
/// Least weight of the best model of each class of adequate models, unless the record is decisive: no test of one speed
/// tells the classes apart for sure.
const LEAST_OF_CLASS: f64 = 0.05;
/// By so much may the independent samples of a misfit be counted too high: a class keeps the weight that it would have
/// with so many times fewer, if that is less.
const FEWER_SAMPLES: f64 = 4.0;

/// Places of models and their weights, which sum to 1; none where no model is adequate.
///
/// Weights are `exp(-d/2)` of the difference `d` of the criterion with priors (Akaike weights: Burnham & Anderson 2002,
/// section 2.9), of the five best, and at least 0.05 or `exp(-d/8)` for the best of each class, whichever is less.
pub fn weights(candidates: &[Candidate]) -> Vec<(usize, f64)> {
    let mut adequate: Vec<(usize, f64)> =
        candidates.iter().enumerate().filter_map(|(k, candidate)| Some((k, candidate.difference?))).collect();
    adequate.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    let mut best_of_class: BTreeMap<EnergyClass, usize> = BTreeMap::new();
    for (k, _) in &adequate {
        best_of_class.entry(candidates[*k].class()).or_insert(*k);
    }
    let is_best = |k: usize| best_of_class.values().any(|best| *best == k);
    let counted = adequate.iter().enumerate().filter(|(place, (k, _))| *place < MOST || is_best(*k));
    let counted: Vec<(usize, f64)> = counted.map(|(_, (k, difference))| (*k, *difference)).collect();
    let weight = |difference: f64| (-0.5 * difference).exp();
    let sum: f64 = counted.iter().map(|(_, difference)| weight(*difference)).sum();
    let least = |difference: f64| LEAST_OF_CLASS.min((-0.5 * difference / FEWER_SAMPLES).exp());
    let floored: Vec<(usize, f64)> = counted
        .into_iter()
        .map(|(k, difference)| {
            let weight = weight(difference) / sum;
            (k, if is_best(k) { weight.max(least(difference)) } else { weight })
        })
        .collect();
    let sum: f64 = floored.iter().map(|(_, weight)| weight).sum();
    floored.into_iter().map(|(k, weight)| (k, weight / sum)).collect()
}

/// The partner as every impact needs it.
pub(crate) struct PreparedPartner<'a> {
    pub partner: &'a Partner,
    /// Of a vehicle its candidate in its own test.
    pub tested: Option<Tested<'a>>,
    /// Its adequate models with their weights.
    others: Vec<(&'a Candidate, OwnTest<'a>, f64)>,
}

impl<'a> PreparedPartner<'a> {
    /// Lets a vehicle meet the wall of its test. Errors: a response that leaves the range of numbers.
    pub fn new(partner: &'a Partner) -> Result<Self, PredictError> {
        let Partner::Vehicle { candidates, place, test, .. } = partner else {
            return Ok(Self { partner, tested: None, others: Vec::new() });
        };
        let own = |(k, weight)| Some((&candidates[k], OwnTest::new(&candidates[k], test).ok()?.0, weight));
        let others = weights(candidates).into_iter().filter_map(own).collect();
        Ok(Self { partner, tested: Some(Tested::new(&candidates[*place], test)?), others })
    }

    /// The mass asked for, kg; `None`: that of its test.
    fn mass_kg(&self) -> Option<f64> {
        match self.partner {
            Partner::Vehicle { mass_kg, .. } => *mass_kg,
            _ => None,
        }
    }

    /// The opponent in a scenario; `None`: the wall. Errors: a mass that leaves its compartment none.
    pub fn opponent(&self, scenario: Scenario) -> Result<Option<Opponent>, PredictError> {
        let structure = match (self.partner, &self.tested) {
            (Partner::Barrier(structure), _) => structure.clone(),
            (_, Some(tested)) => tested.candidate.structure(self.mass_kg())?,
            _ => return Ok(None),
        };
        Ok(Some(Opponent { structure, speed_m_per_s: scenario.partner_speed_m_per_s }))
    }

    /// The opponent with some parameters multiplied by factors.
    pub fn changed(&self, opponent: &Opponent, factors: &BTreeMap<String, f64>) -> Option<Opponent> {
        let structure = self.tested.as_ref()?.candidate.changed(factors, self.mass_kg())?;
        Some(Opponent { structure, ..*opponent })
    }

    /// The opponent, if it is a vehicle, with its mass multiplied by a factor.
    pub fn heavier(&self, opponent: &Opponent, factor: f64) -> Option<Opponent> {
        let mass_kg: f64 = opponent.structure.masses_kg().iter().sum();
        let structure = self.tested.as_ref()?.candidate.structure(Some(factor * mass_kg)).ok()?;
        Some(Opponent { structure, ..*opponent })
    }

    /// The opponent as each of its adequate models, with their weights.
    pub fn others(&self, opponent: &Opponent) -> Vec<(Opponent, &OwnTest<'a>, f64)> {
        let of = |candidate: &Candidate| {
            Some(Opponent { structure: candidate.structure(self.mass_kg()).ok()?, ..*opponent })
        };
        self.others.iter().filter_map(|(candidate, own, weight)| Some((of(candidate)?, own, *weight))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_lumped::{Elastoplastic, Kelvin, Model};

    fn candidate(is_plastic: bool, difference: Option<f64>) -> Candidate {
        let (mass_kg, k) = (1.0, 1.0);
        let model = if is_plastic {
            let (loading_stiffness_n_per_m, unloading_stiffness_n_per_m) = (k, k);
            Model::Elastoplastic(Elastoplastic {
                mass_kg,
                loading_stiffness_n_per_m,
                unloading_stiffness_n_per_m,
                release: true,
            })
        } else {
            Model::Kelvin(Kelvin { mass_kg, stiffness_n_per_m: k, damping_n_s_per_m: 1.0 })
        };
        Candidate { id: format!("{}/direct-fit/1", model.kind()), model: Ok(model), spread: None, difference }
    }

    #[test]
    fn the_best_of_each_class_has_a_say() {
        let all = [
            candidate(false, Some(0.0)),
            candidate(true, Some(20.0)),
            candidate(false, Some(2.0)),
            candidate(false, None),
        ];
        let weights = weights(&all);
        assert_eq!(weights.iter().map(|(k, _)| *k).collect::<Vec<_>>(), [0, 2, 1]);
        // exp(-1) beside 1, and 0.05 of the sum before it was scaled; its own share was exp(-10).
        assert!((weights[1].1 / weights[0].1 - (-1.0_f64).exp()).abs() < 1e-6, "{weights:?}");
        assert!((weights[2].1 - 0.05 / 1.05).abs() < 1e-4, "{weights:?}");
        assert!((weights.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(super::weights(&all[3..]).is_empty());
        // A record that is decisive, exp(-60/8) even with a quarter of the samples, leaves the other class hardly any.
        let decided = super::weights(&[candidate(false, Some(0.0)), candidate(true, Some(60.0))]);
        assert!((decided[1].1 / decided[0].1 - (-7.5_f64).exp()).abs() < 1e-9, "{decided:?}");
    }
}

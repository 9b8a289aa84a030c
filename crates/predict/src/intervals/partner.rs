//! The partner as every impact needs it: what it is, and how it may differ.

use std::collections::BTreeMap;

use crate::error::PredictError;
use crate::impact::candidate::Candidate;
use crate::impact::partner::Opponent;
use crate::impact::scenario::{Partner, Scenario};
use crate::intervals::models::weights;
use crate::intervals::own_test::OwnTest;
use crate::intervals::tested::Tested;

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
        let structure = self.tested.as_ref()?.candidate.changed(factors, self.mass_kg()).ok()?;
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

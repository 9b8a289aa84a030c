//! Double models and their duals, once each has been followed through the filter.

use crumple_lumped::{DoubleSpringMassDamper, Model, ModelKind};
use crumple_lumped_fit::{Candidate, DualScale, FitQuantity, Method};
use crumple_stage::Output;

use crate::stage::assess::candidate_assessment::CandidateAssessment;

/// Two pairs of double models closer than this, in logarithms, are one.
const SAME: f64 = 1e-3;

/// What a candidate is among the double models.
pub trait FitKind {
    /// A double model fitted to the displacement of the compartment alone: one of a pair, or its own dual.
    fn is_double(&self) -> bool;
    /// The second of a pair, which follows from the first.
    fn is_second_of_pair(&self) -> bool;
    /// Fitted to something else than that displacement: assessed by the sensors it was fitted to.
    fn of_sensors(&self) -> bool;
    /// A further explanation of several sensors, which count as for the first one.
    fn shares_weights(&self) -> bool;
    /// Of the same model and method.
    fn is_like(&self, other: &Self) -> bool;
}

impl FitKind for Candidate {
    fn is_double(&self) -> bool {
        self.model.kind() == ModelKind::DoubleSpringMassDamper && self.method == Method::DirectFit && !self.of_sensors()
    }

    fn is_second_of_pair(&self) -> bool {
        self.is_double() && self.equivalent_to.is_some_and(|first| first < self.index)
    }

    fn of_sensors(&self) -> bool {
        self.fit.as_ref().is_some_and(|fit| fit.quantity != FitQuantity::Displacement || !fit.sensors.is_empty())
    }

    fn shares_weights(&self) -> bool {
        self.index > 1 && self.fit.as_ref().is_some_and(|fit| fit.sensors.len() > 1)
    }

    fn is_like(&self, other: &Self) -> bool {
        self.model.kind() == other.model.kind() && self.method == other.method
    }
}

/// Leaves out further explanations of several sensors that, seen through the filters, came to the place of an earlier
/// one.
pub fn drop_repeated(
    candidates: &mut Vec<Candidate>,
    assessed: &mut Vec<Option<CandidateAssessment>>,
    out: &mut Output,
) {
    let mut k = 0;
    while k < candidates.len() {
        let parameters = candidates[k].model.parameters();
        let near = |other: &Candidate| {
            other.is_like(&candidates[k])
                && other.model.parameters().iter().all(|(name, value)| {
                    let size = value.abs().max(parameters[name].abs());
                    (value - parameters[name]).abs() <= SAME * size
                })
        };
        if !candidates[k].shares_weights() || !candidates[..k].iter().any(near) {
            k += 1;
            continue;
        }
        let repeated = candidates.remove(k);
        assessed.remove(k);
        out.notes().info(format!(
            "{}: left out, through the filters of the sensors it is the same set as an earlier \
            one",
            repeated.id()
        ));
        for later in candidates[k..].iter_mut().filter(|later| later.is_like(&repeated)) {
            later.index -= 1;
        }
    }
}

/// Gives every double pair its dual again, best pair first; leaves out pairs that came to the same place, and those
/// that the record tells from the best.
pub fn pair_up(candidates: &mut Vec<Candidate>, assessed: &mut Vec<Option<CandidateAssessment>>, out: &mut Output) {
    let Some(first) = candidates.iter().position(Candidate::is_double) else { return };
    let count = candidates[first..].iter().take_while(|candidate| candidate.is_double()).count();
    let mut pairs: Vec<(Candidate, Option<Candidate>, Option<CandidateAssessment>)> = Vec::new();
    let block: Vec<Candidate> = candidates.drain(first..first + count).collect();
    let assessments: Vec<Option<CandidateAssessment>> = assessed.drain(first..first + count).collect();
    for (a, assessment) in block.iter().zip(assessments).filter(|(a, _)| !a.is_second_of_pair()) {
        let second = block.iter().find(|b| b.is_second_of_pair() && b.equivalent_to == Some(a.index));
        pairs.push((a.clone(), second.cloned(), assessment));
    }
    let rmse = |c: &Candidate| c.fit.as_ref().map_or(f64::INFINITY, |fit| fit.rmse);
    pairs.sort_by(|(a, ..), (b, ..)| rmse(a).total_cmp(&rmse(b)));
    let best = pairs.first().map_or(0.0, |(a, ..)| rmse(a));
    let before = pairs.len();
    let mut kept: Vec<(Candidate, Option<Candidate>, Option<CandidateAssessment>)> = Vec::new();
    for pair in pairs {
        let near = |(other, ..): &(Candidate, Option<Candidate>, Option<CandidateAssessment>)| {
            same(&other.model, &pair.0.model)
        };
        if rmse(&pair.0) <= 1.01 * best + crumple_lumped_fit::RESOLUTION_M && !kept.iter().any(near) {
            kept.push(pair);
        }
    }
    if kept.len() < before {
        out.notes().info(format!(
            "double-spring-mass-damper: through the filter of the record {} of the {before} pairs remain",
            kept.len()
        ));
    }
    let mut place = first;
    for (k, (mut a, b, assessment)) in kept.into_iter().enumerate() {
        let Some(mut b) = b else {
            // Its own dual.
            a.index = 2 * k + 1;
            candidates.insert(place, a);
            assessed.insert(place, assessment);
            place += 1;
            continue;
        };
        if let Model::DoubleSpringMassDamper(model) = a.model {
            let dual = model.dual();
            b.model = Model::DoubleSpringMassDamper(dual);
            let scale = DualScale::new(&model);
            let mut of_b = assessment.as_ref().map(|v| v.of_dual(&scale));
            if let (Some(fit), Some(parameters)) = (&mut b.fit, &a.fit) {
                *fit = parameters.clone();
                fit.active_bounds.iter_mut().for_each(|name| *name = scale.of(name).0);
            }
            let mut of_a = assessment;
            if dual.k1_n_per_m < model.k1_n_per_m {
                std::mem::swap(&mut a.model, &mut b.model);
                std::mem::swap(&mut a.fit, &mut b.fit);
                std::mem::swap(&mut of_a, &mut of_b);
            }
            (a.index, a.equivalent_to) = (2 * k + 1, Some(2 * k + 2));
            (b.index, b.equivalent_to) = (2 * k + 2, Some(2 * k + 1));
            candidates.insert(place, a);
            candidates.insert(place + 1, b);
            assessed.insert(place, of_a);
            assessed.insert(place + 1, of_b);
            place += 2;
        }
    }
}

/// Whether two double models, or one and the dual of the other, are one.
fn same(a: &Model, b: &Model) -> bool {
    let (Model::DoubleSpringMassDamper(a), Model::DoubleSpringMassDamper(b)) = (a, b) else { return false };
    let near = |x: &DoubleSpringMassDamper, y: &DoubleSpringMassDamper| {
        [
            x.k1_n_per_m / y.k1_n_per_m,
            x.k2_n_per_m / y.k2_n_per_m,
            x.c1_n_s_per_m / y.c1_n_s_per_m,
            x.c2_n_s_per_m / y.c2_n_s_per_m,
        ]
        .iter()
        .all(|ratio| (ratio - 1.0).abs() < SAME)
    };
    near(a, b) || near(&a.dual(), b)
}

//! Which candidate stands before which.

use crate::phrases::PHRASES;
use std::cmp::Ordering;

use crate::phrases::words::fill;
use crumple_signal::ANOTHER_VEHICLE;

use crate::findings::{CandidateResult, Run};

/// Fits that differ by less are the same: simulations agree to about 1e-10 percent, and no test decides at 1e-6.
const FIT_STEP_PERCENT: f64 = 1e-6;

/// A model with fewer parameters is preferred unless a larger one fits better by more than this, percentage points of
/// the displacement fit. At 10 m/s and half a metre of crush 0.1 points are about 0.1 mm: less than any sensor knows.
pub const AS_GOOD_PERCENT: f64 = 0.1;

/// A candidate that explains less of the displacement than this, percent, is called best by nobody.
pub const WORTH_NAMING_PERCENT: f64 = 50.0;

/// Candidate ids from the best displacement fit to the worst.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Ranking {
    /// Every candidate with a fit, physical or not, best first.
    pub order: Vec<String>,
    /// The candidate that is recommended for predictions. Where the artifacts hold no recommendation, the best by the
    /// displacement fit: of the candidates that qualify and fit within 0.1 percentage points of the best of them, the
    /// one of which this record leaves the fewest parameters undetermined; among equals the one with the fewest
    /// parameters, then the one that fits best. A chain of two whose masses were looked for by a sensor on the last one
    /// alone stands behind all others.
    pub best: Option<String>,
    /// Why the best is that one, or why there is none.
    pub because: String,
    /// Why this run has no best.
    pub no_best: Option<String>,
}

impl Ranking {
    /// Ranks by [`CandidateResult::fit_percent`]: the displacement fit as measured over the window that was compared,
    /// by default the loading phase.
    ///
    /// Fits are compared to a millionth of a percent, and a parameter set shares the fit of the one it is equivalent
    /// to: rounding does not decide. Equal fits stand in id order. Candidates without a fit are left out. A physical
    /// candidate has every parameter positive.
    pub fn of_candidates(candidates: &[CandidateResult]) -> Self {
        let stands_for = pairs_of_equals(candidates);
        let fit = |index: usize| candidates[index].fit_percent().filter(|fit| !fit.is_nan());
        let mut fitted: Vec<(f64, &CandidateResult)> = candidates
            .iter()
            .enumerate()
            .filter_map(|(index, candidate)| {
                let fit_percent = fit(index)?;
                let shared = fit(stands_for[index]).unwrap_or(fit_percent);
                Some(((shared / FIT_STEP_PERCENT).round(), candidate))
            })
            .collect();
        fitted.sort_by(|(fit_a, a), (fit_b, b)| fit_b.total_cmp(fit_a).then_with(|| compare_ids(&a.id, &b.id)));
        Self {
            order: fitted.iter().map(|(_, candidate)| candidate.id.clone()).collect(),
            best: best_of_the_good(&fitted).map(|candidate| candidate.id.clone()),
            because: PHRASES.remarks.by_fit_alone.to_owned(),
            no_best: None,
        }
    }

    /// As [`Ranking::of_candidates`], the best that of the recommendation where there is one; without one no best where
    /// the pulse is no crush along the vehicle: a model of springs that stop a mass is no explanation of a lateral or
    /// vertical record, nor, beyond its window, of one that never stops.
    pub fn of_run(run: &Run) -> Self {
        let mut ranking = Self::of_candidates(&run.candidates);
        if let Some(choice) = &run.recommendation {
            ranking.best.clone_from(&choice.recommended);
            ranking.because.clone_from(&choice.recommended_because);
            ranking.no_best = choice.recommended.is_none().then(|| choice.recommended_because.clone());
            return ranking;
        }
        ranking.no_best = no_crush(run);
        if let Some(reason) = &ranking.no_best {
            ranking.best = None;
            ranking.because.clone_from(reason);
        }
        ranking
    }

    /// Of the candidates of coefficient matching the one whose simulation fits best, physical or not: the solution that
    /// the simulation supports.
    pub fn best_of_matching<'a>(&self, run: &'a Run) -> Option<&'a CandidateResult> {
        let matched = |id: &String| run.candidate(id).filter(|c| c.record.method == "coefficient-matching");
        self.order.iter().find_map(matched)
    }

    /// The candidate to show where one is shown: the best; without a best the first that goes before others, else the
    /// first.
    pub fn leading<'a>(&self, run: &'a Run) -> Option<&'a CandidateResult> {
        let mut ranked = self.order.iter().filter_map(|id| run.candidate(id));
        let best = self.best.as_deref().and_then(|id| run.candidate(id));
        best.or_else(|| ranked.clone().find(|candidate| is_preferred(candidate))).or_else(|| ranked.next())
    }

    /// Place of a candidate, counted from 1.
    pub fn place(&self, id: &str) -> Option<usize> {
        self.order.iter().position(|other| other == id).map(|index| index + 1)
    }
}

/// Why there is no crush along the vehicle's axis to be explained; `None` where there is one, or no events were looked
/// for.
fn no_crush(run: &Run) -> Option<String> {
    let events = run.events.as_ref()?;
    let texts = &PHRASES.remarks;
    if let Some(axis) = run.other_axis() {
        return Some(fill(texts.other_axis, &[("channel", events.channel.clone()), ("axis", axis.to_string())]));
    }
    if run.test.barrier.as_deref() == Some(ANOTHER_VEHICLE) {
        return Some(PHRASES.conclusion.warn_two_vehicles.to_owned());
    }
    let crushed = events.time_of_dynamic_crush_s.is_some() && events.dynamic_crush_m.is_some_and(|crush| crush > 0.0);
    (!crushed).then(|| texts.no_end_of_crush.to_owned())
}

/// Whether a candidate may be called the best: physical, no parameter left on a bound of its search (such a value is
/// the bound's, not the record's; zero, the limit of what is physical, is an answer), and a displacement fit of at
/// least [`WORTH_NAMING_PERCENT`].
pub fn qualifies(candidate: &CandidateResult) -> bool {
    candidate.record.physical && is_preferred(candidate)
}

/// Whether a candidate goes before others: no parameter is on a bound of its search, and half of the displacement is
/// explained.
pub fn is_preferred(candidate: &CandidateResult) -> bool {
    free_of_bounds(candidate) && candidate.fit_percent().is_some_and(|fit| fit >= WORTH_NAMING_PERCENT)
}

/// Whether no parameter was left on a bound of its search other than zero.
pub fn free_of_bounds(candidate: &CandidateResult) -> bool {
    candidate.record.fit.as_ref().is_none_or(|fit| {
        fit.active_bounds.iter().all(|name| candidate.record.parameters.get(name).is_some_and(|value| *value == 0.0))
    })
}

/// `fitted` holds fits in steps of [`FIT_STEP_PERCENT`], best first.
fn best_of_the_good<'a>(fitted: &[(f64, &'a CandidateResult)]) -> Option<&'a CandidateResult> {
    let good: Vec<_> = fitted.iter().filter(|(_, candidate)| qualifies(candidate)).collect();
    let (top, _) = good.first()?;
    // `min_by_key` takes the first of equals, which is the one that fits best.
    good.iter()
        .take_while(|(fit, _)| (top - fit) * FIT_STEP_PERCENT <= AS_GOOD_PERCENT)
        .min_by_key(|(_, candidate)| {
            (candidate.divides_by_formula(), candidate.left_open(), candidate.record.parameters.len())
        })
        .map(|(_, candidate)| *candidate)
}

/// Sort key of a candidate id: its parts, the last as a number where it is one, so that `.../10` comes after `.../2`.
pub fn id_key(id: &str) -> (&str, u64, &str) {
    match id.rsplit_once('/') {
        Some((family, index)) => (family, index.parse().unwrap_or(u64::MAX), index),
        None => (id, u64::MAX, ""),
    }
}

/// Compares two candidate ids by model, method and number.
pub fn compare_ids(a: &str, b: &str) -> Ordering {
    id_key(a).cmp(&id_key(b))
}

/// For each candidate the index of the one that stands for it in a drawing: itself, or an earlier candidate that
/// gives exactly the same record (`equivalent_to`, in either direction).
pub fn pairs_of_equals(candidates: &[CandidateResult]) -> Vec<usize> {
    let mut stands_for: Vec<usize> = (0..candidates.len()).collect();
    for (index, candidate) in candidates.iter().enumerate() {
        let earlier = candidates[..index].iter().position(|other| {
            candidate.record.equivalent_to.as_deref() == Some(other.id.as_str())
                || other.record.equivalent_to.as_deref() == Some(candidate.id.as_str())
        });
        if let Some(earlier) = earlier {
            stands_for[index] = stands_for[earlier];
        }
    }
    stands_for
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use crumple_artifact::records::{CandidateV1, FitV1, SimulationV1, UncertaintyV1};

    use super::*;

    fn candidate(id: &str, fit_percent: f64, physical: bool, equivalent_to: Option<&str>) -> CandidateResult {
        let (model, rest) = id.split_once('/').unwrap();
        CandidateResult {
            id: id.to_owned(),
            record: CandidateV1 {
                model: model.to_owned(),
                method: rest.to_owned(),
                parameters: BTreeMap::new(),
                physical,
                equivalent_to: equivalent_to.map(str::to_owned),
                fit: None,
                uncertainty: None,
                notes: vec![],
                evaluation: None,
            },
            simulation: Some(SimulationV1 { fit_percent: Some(fit_percent), to_s: 0.07, ..SimulationV1::default() }),
            ..CandidateResult::default()
        }
    }

    #[test]
    fn rounding_does_not_choose_between_a_set_and_its_dual() {
        let candidates = [
            candidate("double/fit/1", 99.07, true, Some("double/fit/2")),
            candidate("double/fit/2", 99.070_000_000_000_3, true, Some("double/fit/1")),
            candidate("kelvin/fit/1", 99.8, false, None),
            candidate("maxwell/fit/1", -12.0, true, None),
        ];
        let ranking = Ranking::of_candidates(&candidates);
        assert_eq!(ranking.best.as_deref(), Some("double/fit/1"));
        assert_eq!(ranking.order, ["kelvin/fit/1", "double/fit/1", "double/fit/2", "maxwell/fit/1"]);
        assert_eq!(pairs_of_equals(&candidates), [0, 0, 2, 3]);
    }

    #[test]
    fn the_smaller_of_two_models_that_fit_alike_is_the_best() {
        let mut candidates =
            [candidate("double/fit/1", 99.99, true, None), candidate("kelvin/closed-form/1", 99.95, true, None)];
        let parameters = |n: usize| (0..n).map(|k| (format!("p{k}"), 1.0)).collect();
        candidates[0].record.parameters = parameters(6);
        candidates[1].record.parameters = parameters(3);
        let ranking = Ranking::of_candidates(&candidates);
        assert_eq!(ranking.best.as_deref(), Some("kelvin/closed-form/1"));
        assert_eq!(ranking.order, ["double/fit/1", "kelvin/closed-form/1"]);
        candidates[1].simulation.as_mut().unwrap().fit_percent = Some(99.8);
        assert_eq!(Ranking::of_candidates(&candidates).best.as_deref(), Some("double/fit/1"));
    }

    /// Leaves the first so many parameters open.
    fn open(candidate: &mut CandidateResult, count: usize) {
        let names = candidate.record.parameters.keys().cloned().collect::<Vec<_>>();
        let ends = |k: usize| if k < count { None } else { Some(1.0) };
        let interval: BTreeMap<String, Option<f64>> =
            names.into_iter().enumerate().map(|(k, name)| (name, ends(k))).collect();
        candidate.record.uncertainty =
            Some(UncertaintyV1 { interval_low: interval.clone(), interval_high: interval, ..UncertaintyV1::default() });
    }

    #[test]
    fn of_models_that_fit_alike_the_one_that_the_record_determines_is_the_best() {
        let mut candidates = [
            candidate("nonlinear-1/fit/1", 99.99, true, None),
            candidate("double/fit/1", 99.95, true, None),
            candidate("kelvin/fit/1", 99.0, true, None),
        ];
        let parameters = |n: usize| (0..n).map(|k| (format!("p{k}"), 1.0)).collect();
        for (candidate, (count, undetermined)) in candidates.iter_mut().zip([(5, 3), (6, 1), (3, 0)]) {
            candidate.record.parameters = parameters(count);
            open(candidate, undetermined);
        }
        // One parameter more, two less in doubt; Kelvin is a whole point behind.
        assert_eq!(Ranking::of_candidates(&candidates).best.as_deref(), Some("double/fit/1"));
        open(&mut candidates[0], 1);
        assert_eq!(Ranking::of_candidates(&candidates).best.as_deref(), Some("nonlinear-1/fit/1"));
    }

    #[test]
    fn a_chain_that_divides_the_mass_by_a_formula_gives_way_to_any_other_that_fits_alike() {
        let mut candidates = [
            candidate("chain/car/1", 99.99, true, Some("chain/car/2")),
            candidate("chain/car/2", 99.99, true, Some("chain/car/1")),
            candidate("nonlinear-2/fit/1", 99.95, true, None),
        ];
        for chain in &mut candidates[..2] {
            chain.record.parameters = ["m1_kg", "m2_kg"].map(|name| (name.to_owned(), 1.0)).into();
            open(chain, 0);
        }
        candidates[2].record.parameters = (0..9).map(|k| (format!("p{k}"), 1.0)).collect();
        assert!(candidates[0].divides_by_formula());
        assert_eq!(Ranking::of_candidates(&candidates).best.as_deref(), Some("nonlinear-2/fit/1"));
        candidates[2].simulation.as_mut().unwrap().fit_percent = Some(90.0);
        assert_eq!(Ranking::of_candidates(&candidates).best.as_deref(), Some("chain/car/1"));
        // Masses that were given.
        candidates[2].simulation.as_mut().unwrap().fit_percent = Some(99.95);
        candidates[0].record.uncertainty = None;
        assert_eq!(Ranking::of_candidates(&candidates).best.as_deref(), Some("chain/car/1"));
    }

    #[test]
    fn a_parameter_on_a_bound_or_a_poor_fit_is_never_the_best() {
        let mut candidates = [candidate("double/fit/1", 99.9, true, None), candidate("kelvin/fit/1", 97.0, true, None)];
        candidates[0].record.fit = Some(FitV1 {
            channel: "a".into(),
            quantity: "displacement".into(),
            from_s: 0.0,
            to_s: 0.07,
            samples: 100,
            rmse: 1e-3,
            iterations: 10,
            evaluations: 100,
            stop_reason: "on-bound".into(),
            active_bounds: vec!["k2_n_per_m".into()],
            sensors: vec![],
        });
        assert_eq!(Ranking::of_candidates(&candidates).best.as_deref(), Some("kelvin/fit/1"));
        candidates[1].simulation.as_mut().unwrap().fit_percent = Some(28.7);
        assert_eq!(Ranking::of_candidates(&candidates).best, None);
    }

    #[test]
    fn without_a_physical_candidate_there_is_no_best() {
        let ranking = Ranking::of_candidates(&[candidate("kelvin/fit/1", 99.8, false, None)]);
        assert_eq!((ranking.best, ranking.order.len()), (None, 1));
    }

    #[test]
    fn an_index_is_compared_as_a_number() {
        assert_eq!(compare_ids("kelvin/closed-form/10", "kelvin/closed-form/2"), Ordering::Greater);
        assert_eq!(compare_ids("elastoplastic/closed-form/1", "kelvin/closed-form/1"), Ordering::Less);
    }
}

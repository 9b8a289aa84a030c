//! Which candidate stands before which: the order of `/recommendation`. Nothing is chosen here.

use std::cmp::Ordering;

use crate::findings::{CandidateResult, Run};

/// Why none is recommended where nobody chose.
const NO_CHOICE: &str = "parameter-solve made no choice among the candidates";

/// Candidate ids in the order of the choice, and the one that it recommends.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Ranking {
    /// Every candidate: those that the choice rated in its order, each with its dual behind it; then the others by
    /// their displacement fit, highest first, and without a fit by their ids.
    pub order: Vec<String>,
    /// The candidate that the choice recommends for predictions.
    pub best: Option<String>,
    /// Why it is that one, or why there is none.
    pub because: String,
}

impl Ranking {
    /// As `/recommendation` has it; without that record none is recommended.
    pub fn of_run(run: &Run) -> Self {
        let choice = run.recommendation.as_ref();
        let rated = choice.map(|choice| choice.candidates.as_slice()).unwrap_or_default();
        let stands_for = pairs_of_equals(&run.candidates);
        let place = |index: usize| rated.iter().position(|rated| rated.id == run.candidates[index].id);
        // A dual is rated with the candidate that it is equivalent to.
        let place_of_pair = |index: usize| {
            let pair = (0..stands_for.len()).filter(|other| stands_for[*other] == stands_for[index]);
            pair.filter_map(place).min().unwrap_or(usize::MAX)
        };
        let fit = |index: usize| run.candidates[index].fit_percent().unwrap_or(f64::NEG_INFINITY);
        let mut order: Vec<usize> = (0..run.candidates.len()).collect();
        order.sort_by(|a, b| {
            let by_choice = |index: usize| (place_of_pair(index), place(index).is_none());
            by_choice(*a).cmp(&by_choice(*b)).then_with(|| fit(*b).total_cmp(&fit(*a)))
        });
        Self {
            order: order.into_iter().map(|index| run.candidates[index].id.clone()).collect(),
            best: choice.and_then(|choice| choice.recommended.clone()),
            because: choice.map_or_else(|| NO_CHOICE.to_owned(), |choice| choice.recommended_because.clone()),
        }
    }

    /// Why none of the candidates is recommended; `None` where one is, or there are none.
    pub fn no_best(&self) -> Option<&str> {
        (self.best.is_none() && !self.order.is_empty()).then_some(self.because.as_str())
    }

    /// Of the candidates of coefficient matching the one whose simulation fits best, physical or not: the solution that
    /// the simulation supports.
    pub fn best_of_matching<'a>(&self, run: &'a Run) -> Option<&'a CandidateResult> {
        let ranked = self.order.iter().rev().filter_map(|id| run.candidate(id));
        let matched = ranked.filter(|candidate| candidate.record.method == "coefficient-matching");
        let fitted = matched.filter_map(|candidate| Some((candidate.fit_percent()?, candidate)));
        fitted.max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, candidate)| candidate)
    }

    /// The candidate to show where one is shown: the recommended, else the first.
    pub fn leading<'a>(&self, run: &'a Run) -> Option<&'a CandidateResult> {
        self.best.iter().chain(&self.order).find_map(|id| run.candidate(id))
    }

    /// Place of a candidate, counted from 1.
    pub fn place(&self, id: &str) -> Option<usize> {
        self.order.iter().position(|other| other == id).map(|index| index + 1)
    }
}

/// Says that no model is recommended.
pub(crate) fn none_recommended(because: &str) -> String {
    format!("No model is recommended: {because}.")
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
    use crumple_artifact::records::{CandidateV1, RatedCandidateV1, RecommendationV1, SimulationV1};
    use serde_json::json;

    use super::*;

    fn candidate(id: &str, fit_percent: f64, equivalent_to: Option<&str>) -> CandidateResult {
        let (model, method) = id.split_once('/').unwrap();
        let record: CandidateV1 = serde_json::from_value(json!({
            "model": model, "method": method, "parameters": {}, "physical": true, "equivalent_to": equivalent_to,
            "fit": null, "uncertainty": null
        }))
        .unwrap();
        let simulation = SimulationV1 { fit_percent: Some(fit_percent), ..SimulationV1::default() };
        CandidateResult { id: id.to_owned(), record, simulation: Some(simulation), ..CandidateResult::default() }
    }

    fn run() -> Run {
        let candidates = vec![
            candidate("double/fit/1", 99.07, Some("double/fit/2")),
            candidate("double/fit/2", 99.07, Some("double/fit/1")),
            candidate("kelvin/fit/1", 99.8, None),
            candidate("maxwell/fit/1", 99.9, None),
        ];
        Run { candidates, ..Run::default() }
    }

    #[test]
    fn the_order_is_that_of_the_choice_and_a_dual_stands_behind_its_own() {
        let mut run = run();
        let rated = |id: &str| RatedCandidateV1 { id: id.to_owned(), ..RatedCandidateV1::default() };
        run.recommendation = Some(RecommendationV1 {
            recommended: Some("kelvin/fit/1".to_owned()),
            recommended_because: "it is simple".to_owned(),
            candidates: vec![rated("double/fit/2"), rated("kelvin/fit/1")],
            ..RecommendationV1::default()
        });
        let ranking = Ranking::of_run(&run);
        assert_eq!(ranking.order, ["double/fit/2", "double/fit/1", "kelvin/fit/1", "maxwell/fit/1"]);
        assert_eq!((ranking.best.as_deref(), ranking.no_best()), (Some("kelvin/fit/1"), None));
        assert_eq!(ranking.leading(&run).unwrap().id, "kelvin/fit/1");
        assert_eq!(pairs_of_equals(&run.candidates), [0, 0, 2, 3]);
    }

    #[test]
    fn without_a_choice_none_is_recommended_and_the_closest_stands_first() {
        let ranking = Ranking::of_run(&run());
        assert_eq!(ranking.order, ["maxwell/fit/1", "kelvin/fit/1", "double/fit/1", "double/fit/2"]);
        assert_eq!((ranking.best.as_deref(), ranking.no_best()), (None, Some(NO_CHOICE)));
    }

    #[test]
    fn numbers_of_candidates_are_numbers() {
        assert_eq!(compare_ids("kelvin/closed-form/10", "kelvin/closed-form/2"), Ordering::Greater);
        assert_eq!(compare_ids("elastoplastic/closed-form/1", "kelvin/closed-form/1"), Ordering::Less);
    }
}

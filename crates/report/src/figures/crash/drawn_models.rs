//! Which candidates are drawn over the test, under which name, and how.

use crate::words;
use std::collections::BTreeSet;

use crate::drawing::{Figure, Look};
use crate::findings::{CandidateResult, Ranking, Run, capitalised, ranking::pairs_of_equals};

use crate::figures::shown_at_first::at_first;

/// Candidates shown at first where nobody recommends one.
const SHOWN: usize = 2;

/// The candidates with a motion, one of each pair that gives the same record, best first.
pub struct DrawnModels<'a> {
    /// Each with its name in a legend.
    pub models: Vec<(&'a CandidateResult, String)>,
    shown: BTreeSet<&'a str>,
    /// How many are drawn as another.
    pub equals: usize,
}

impl<'a> DrawnModels<'a> {
    /// Of the run. Shown at first are the recommended and the closest, and every chain of a person's own.
    pub fn of(run: &'a Run, ranking: &Ranking) -> Self {
        let stands_for = pairs_of_equals(&run.candidates);
        let mut drawn: Vec<(usize, &CandidateResult)> = run
            .candidates
            .iter()
            .enumerate()
            .filter(|(index, candidate)| stands_for[*index] == *index && candidate.displacement.is_some())
            .collect();
        drawn.sort_by_key(|(index, candidate)| (ranking.place(&candidate.id).unwrap_or(usize::MAX), *index));
        let ranked: Vec<&CandidateResult> = drawn.iter().map(|(_, candidate)| *candidate).collect();
        // A name of the recommendation may be that of a twin.
        let drawn_as = |id: &str| {
            let index = run.candidates.iter().position(|candidate| candidate.id == id)?;
            run.candidates.get(stands_for[index]).map(|candidate| candidate.id.as_str())
        };
        let recommended = ranking.best.as_deref().and_then(drawn_as);
        let closest = run.recommendation.as_ref().and_then(|r| drawn_as(r.closest.as_deref()?));
        let shown = match (recommended, closest) {
            (Some(recommended), Some(closest)) => {
                let own = ranked.iter().filter(|candidate| candidate.is_chain()).map(|c| c.id.as_str());
                [recommended, closest].into_iter().chain(own).collect()
            }
            _ => at_first(&ranked, ranking, SHOWN),
        };
        let fits = fit_texts(&ranked);
        let equals_of = |index: usize| stands_for.iter().filter(|drawn_as| **drawn_as == index).count() - 1;
        let mut models: Vec<(&CandidateResult, String)> = drawn
            .iter()
            .zip(&fits)
            .map(|((index, candidate), fit)| {
                let role = match (Some(candidate.id.as_str()) == recommended, Some(candidate.id.as_str()) == closest) {
                    (true, true) => "recommended and closest: ",
                    (true, false) => "recommended: ",
                    (false, true) => "closest: ",
                    (false, false) => "",
                };
                let name = name(run, candidate, fit.as_deref(), equals_of(*index));
                (*candidate, if role.is_empty() { capitalised(&name) } else { format!("{role}{name}") })
            })
            .collect();
        // The recommended and the closest first, then what else is shown: they have the colours before they repeat.
        let order = |id: &str| (Some(id) != recommended, Some(id) != closest, !shown.contains(id));
        models.sort_by_key(|(candidate, _)| order(&candidate.id));
        let equals = drawn.iter().map(|(index, _)| equals_of(*index)).sum();
        Self { models, shown, equals }
    }

    /// The recommended one alone, or none.
    pub fn recommended(mut self, ranking: &Ranking) -> Self {
        let of_models = self.shown.len().min(1);
        self.models.truncate(if ranking.best.is_some() { of_models } else { 0 });
        self
    }

    /// Whether any waits in the legend.
    pub fn hides_some(&self) -> bool {
        self.models.iter().any(|(candidate, _)| !self.shown.contains(candidate.id.as_str()))
    }

    /// Whether one is shown at first.
    pub fn is_shown(&self, candidate: &CandidateResult) -> bool {
        self.shown.contains(candidate.id.as_str())
    }

    /// Puts them into a figure's legend, in their order.
    pub fn entries(&self, figure: &mut Figure) -> Vec<usize> {
        let models = self.models.iter().enumerate();
        models.map(|(k, (c, name))| figure.entry(name, Look::of_series(k), self.is_shown(c))).collect()
    }
}

/// Fits in percent to two decimals, as in the table of candidates; to three where two are equal in print.
fn fit_texts(candidates: &[&CandidateResult]) -> Vec<Option<String>> {
    let fits = candidates.iter().map(|candidate| candidate.fit_percent());
    let texts: Vec<_> = fits.map(|fit| fit.map(|fit| (fit, words::decimals(fit, 2)))).collect();
    let twice = |text: &str| texts.iter().flatten().filter(|(_, other)| other == text).count() > 1;
    let text = |known: &Option<(f64, String)>| {
        let (fit, text) = known.as_ref()?;
        Some(if twice(text) { words::decimals(*fit, 3) } else { text.clone() })
    };
    texts.iter().map(text).collect()
}

/// `Kelvin model (fitted), 99.07 %, and its dual: same record`: what stands behind the parenthesis is left out where
/// there is little room.
fn name(run: &Run, candidate: &CandidateResult, fit: Option<&str>, equals: usize) -> String {
    let mut parts = vec![run.name_of(&candidate.id)];
    parts.extend(fit.map(|fit| format!("{fit} %")));
    if equals > 0 {
        parts.push("and its dual: same record".to_owned());
    }
    if !candidate.record.physical {
        parts.push("not physical".to_owned());
    }
    parts.join(", ")
}

//! The choice: what each candidate weighs in a prediction, which weighs most, which is the simplest, which follows the
//! record closest.
//!
//! A candidate is scored by what it predicts of the record before it is fitted to it
//! ([`Evidence`](crate::selection::evidence::Evidence)). What is known of vehicles beside the record adds squared terms
//! ([`SelectionRules::terms`]). Weights are `exp(-d/2)` of the difference `d` of the sums, and the recommended
//! candidate is the one that weighs most.

use std::cmp::Ordering;

use crate::selection::compared::{ComparedCandidate, EnergyClass, Inadequacy, Prior, SelectionRules};
use crate::selection::rating::{ComparedRecord, Rated, rate_all};

/// Differences of the sum above which the evidence is decisive: a weight of 0.7 % beside it (Burnham & Anderson 2002,
/// section 2.6).
const DECISIVE: f64 = 10.0;
/// Fits that differ by less, percentage points, are the same, as they are said: no sensor decides between them.
const FIT_STEP: f64 = 0.01;

/// A name of the choice: a candidate, or none, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Place of the candidate among those given.
    pub candidate: Option<usize>,
    /// Why, in one sentence.
    pub because: String,
}

/// How the evidence for the recommended candidate stands to that for the best of another model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strength {
    /// Sums differ by 10 at most.
    Weak,
    /// The sum is lower by more than 10.
    Decisive,
}

/// The three names, and all that was counted for them.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateSelection {
    /// For prediction.
    pub recommended: Choice,
    /// The evidence beside the best of another model, and the place of that; `None`: no other qualifies, or none is
    /// recommended.
    pub strength: Option<(Strength, usize)>,
    /// Fewest parameters, all of them determined.
    pub simplest: Choice,
    /// Closest to the record.
    pub closest: Choice,
    /// In the order of the candidates.
    pub rated: Vec<Rated>,
    /// Terms of the record that all were compared by; `None`: none is adequate.
    pub terms: Option<usize>,
    /// Priors in use.
    pub priors: Vec<Prior>,
}

/// Chooses among candidates of which none is the dual of another: the same model twice is one.
///
/// *Adequate*: physical, no parameter on a bound of its search, a displacement fit of at least
/// [`SelectionRules::adequate_fit_percent`], and the events of its own test. Where none of these is for prediction,
/// those that miss only time, restitution or a sensor take part too. *For prediction*: of these each but one whose
/// energy does not go into plastic deformation and that has numbers which nothing determines and other speeds feel, as
/// long as the record's own force over crush answers, in a plastic candidate. *Recommended*: the one of largest weight.
/// *Simplest*: of the adequate with all numbers determined the fewest, then the lowest sum. *Closest*: of the physical
/// the best displacement fit.
pub fn choose(candidates: &[ComparedCandidate], record: &ComparedRecord, rules: &SelectionRules) -> CandidateSelection {
    let adequate = selection(candidates, record, rules, <[Inadequacy]>::is_empty);
    if adequate.recommended.candidate.is_some() {
        return adequate;
    }
    let with_the_crush = |reasons: &[Inadequacy]| reasons.iter().all(Inadequacy::leaves_the_crush);
    let of_crush = selection(candidates, record, rules, with_the_crush);
    if of_crush.recommended.candidate.is_none() {
        return adequate;
    }
    CandidateSelection { simplest: adequate.simplest, closest: adequate.closest, ..of_crush }
}

/// The choice among candidates whose inadequacies let them take part.
fn selection(
    candidates: &[ComparedCandidate],
    record: &ComparedRecord,
    rules: &SelectionRules,
    takes_part: fn(&[Inadequacy]) -> bool,
) -> CandidateSelection {
    let (mut rated, terms) = rate_all(candidates, record, rules, takes_part);
    let all = ComparedCandidates { candidates, rated: &rated };
    let for_prediction: Vec<usize> = all.compared().filter(|k| all.not_for_prediction(*k).is_none()).collect();
    let (recommended, simplest, closest) = (all.recommended(&for_prediction, terms), all.simplest(), all.closest());
    let strength = recommended.candidate.and_then(|best| all.strength(best, &for_prediction));
    let lowest = for_prediction.iter().filter_map(|k| all.total(*k)).reduce(f64::min).unwrap_or(0.0);
    let weights: Vec<(usize, f64)> =
        for_prediction.iter().filter_map(|k| Some((*k, (-0.5 * (all.total(*k)? - lowest)).exp()))).collect();
    let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
    weights.into_iter().for_each(|(k, weight)| rated[k].weight = weight / sum);
    CandidateSelection {
        recommended,
        strength,
        simplest,
        closest,
        rated,
        terms,
        priors: rules.priors(record.restitution),
    }
}

/// All that the three names are chosen from.
struct ComparedCandidates<'a> {
    candidates: &'a [ComparedCandidate],
    rated: &'a [Rated],
}

impl ComparedCandidates<'_> {
    fn none(because: impl Into<String>) -> Choice {
        Choice { candidate: None, because: because.into() }
    }

    /// Those that take part in the choice.
    fn compared(&self) -> impl Iterator<Item = usize> {
        (0..self.candidates.len()).filter(|k| self.rated[*k].is_compared)
    }

    fn is_plastic(&self, k: usize) -> bool {
        self.candidates[k].class == EnergyClass::Plastic
    }

    /// The sum of score and priors above the lowest; `None`: it has no score.
    fn total(&self, k: usize) -> Option<f64> {
        self.rated[k].difference_with_priors
    }

    /// The lowest sum first, then those without one.
    fn by_total(&self, a: usize, b: usize) -> Ordering {
        match (self.total(a), self.total(b)) {
            (Some(a), Some(b)) => a.total_cmp(&b),
            (a, b) => a.is_none().cmp(&b.is_none()),
        }
        .then(a.cmp(&b))
    }

    /// How much the sum of `b` is above that of `a`; `None` where one has none.
    fn gap(&self, a: usize, b: usize) -> Option<f64> {
        Some(self.total(b)? - self.total(a)?)
    }

    /// Why a candidate that takes part is not for prediction.
    fn not_for_prediction(&self, k: usize) -> Option<String> {
        let candidate = &self.candidates[k];
        if self.rated[k].score.is_none() {
            return Some("it has no finite score".to_owned());
        }
        let (open, of) = (candidate.affects_other_speeds.len(), candidate.parameters);
        let none_is_known = candidate.is_assessed && of > 0 && candidate.determined() == 0;
        let record_answers = || self.compared().any(|k| self.is_plastic(k) && self.rated[k].score.is_some());
        ((open > 0 || none_is_known) && !self.is_plastic(k) && record_answers()).then(|| match open {
            0 => format!("none of its {of} numbers is determined"),
            _ => format!("{open} of its {of} numbers are not determined and felt at other speeds"),
        })
    }

    fn recommended(&self, for_prediction: &[usize], terms: Option<usize>) -> Choice {
        let Some(terms) = terms else { return Self::none(self.why_none_is_adequate()) };
        let Some(best) = for_prediction.iter().copied().min_by(|a, b| self.by_total(*a, *b)) else {
            let reasons: Vec<String> = self
                .compared()
                .filter_map(|k| Some(format!("{}: {}", self.candidates[k].id, self.not_for_prediction(k)?)))
                .collect();
            return Self::none(format!("no adequate candidate qualifies ({})", reasons.join("; ")));
        };
        let of_another_model = self.strength(best, for_prediction).map(|(_, next)| next);
        let any = || for_prediction.iter().copied().filter(|k| *k != best).min_by(|a, b| self.by_total(*a, *b));
        let next = of_another_model.or_else(any);
        let candidate = &self.candidates[best];
        let mut because = format!(
            "{}, {}{}, {}",
            candidate.class.name(),
            candidate.determined_in_words(),
            match (candidate.unidentified.len(), candidate.affects_other_speeds.len()) {
                (0, _) => String::new(),
                (_, 0) => " and hardly felt at other speeds".to_owned(),
                (_, felt) => format!(" ({felt} felt at other speeds)"),
            },
            match next {
                Some(next) => self.beside_the_next(best, next),
                None if self.rated[best].is_adequate() => "the only adequate candidate for prediction".to_owned(),
                None => "the only candidate with the crush of the test for prediction".to_owned(),
            }
        );
        if let Some(missed) = self.rated[best].why_inadequate() {
            because.push_str(&format!("; use only its crush: it {missed}"));
        }
        because.push_str(&format!(" (score as measured, with priors; {terms} terms below 60 Hz)"));
        let passed_over = self
            .compared()
            .filter_map(|k| Some((k, self.gap(k, best).filter(|better| *better > 0.0)?, self.not_for_prediction(k)?)))
            .min_by(|(a, ..), (b, ..)| self.by_total(*a, *b));
        if let Some((k, better, why)) = passed_over {
            let id = &self.candidates[k].id;
            because.push_str(&format!("; {id} stands {better:.1} lower, but {why}"));
        }
        Choice { candidate: Some(best), because }
    }

    /// How the sum stands to that of the next.
    fn beside_the_next(&self, best: usize, next: usize) -> String {
        let (id, gap) = (&self.candidates[next].id, self.gap(best, next).unwrap_or(0.0));
        let weight = if gap > DECISIVE { "decisive" } else { "weak" };
        format!("its score is {gap:.1} lower than for {id}: {weight} evidence")
    }

    /// How the evidence for a recommended candidate stands to that for the best of another model for prediction.
    fn strength(&self, best: usize, for_prediction: &[usize]) -> Option<(Strength, usize)> {
        let is_other = |k: &usize| self.candidates[*k].model != self.candidates[best].model;
        let next = for_prediction.iter().copied().filter(is_other).min_by(|a, b| self.by_total(*a, *b))?;
        Some((if self.gap(best, next)? > DECISIVE { Strength::Decisive } else { Strength::Weak }, next))
    }

    fn simplest(&self) -> Choice {
        let determined: Vec<usize> = self.compared().filter(|k| self.candidates[*k].unidentified.is_empty()).collect();
        let Some(simplest) = determined.iter().copied().min_by(|a, b| self.by_parameters(*a, *b)) else {
            return Self::none(match self.compared().count() {
                0 => self.why_none_is_adequate(),
                n => format!("each of the {n} adequate candidates has a number that the record does not determine"),
            });
        };
        let candidate = &self.candidates[simplest];
        let fit = candidate.fit_percent.unwrap_or(0.0);
        let count = match candidate.parameters {
            _ if candidate.order_of_magnitude > 0 || !candidate.is_assessed => candidate.determined_in_words(),
            1 => "one number, determined".to_owned(),
            n => format!("{n} numbers, all determined"),
        };
        let missed = self.rated[simplest].why_inadequate();
        let missed = missed.map_or_else(String::new, |missed| format!("; use only its crush: it {missed}"));
        let because = format!("{count}, displacement fit as measured {fit:.2} %{missed}");
        Choice { candidate: Some(simplest), because }
    }

    fn closest(&self) -> Choice {
        let step = |k: usize| self.candidates[k].fit_percent.map(|fit| (fit / FIT_STEP).round());
        let physical = (0..self.candidates.len()).filter(|k| self.candidates[*k].physical && step(*k).is_some());
        let closest = physical.min_by(|a, b| {
            step(*b).unwrap_or(0.0).total_cmp(&step(*a).unwrap_or(0.0)).then_with(|| self.by_parameters(*a, *b))
        });
        let Some(closest) = closest else { return Self::none("no physical candidate has a displacement to compare") };
        let candidate = &self.candidates[closest];
        let fit = candidate.fit_percent.unwrap_or(0.0);
        let (open, of) = (candidate.unidentified.len() + candidate.on_bound.len(), candidate.parameters);
        let open = if open == 0 { String::new() } else { format!("; {open} of its {of} numbers not determined") };
        let because = format!("best displacement fit of the physical candidates, {fit:.2} % as measured{open}");
        Choice { candidate: Some(closest), because }
    }

    /// Fewest numbers first, then the lowest sum, then the order given.
    fn by_parameters(&self, a: usize, b: usize) -> Ordering {
        let count = |k: usize| self.candidates[k].parameters;
        count(a).cmp(&count(b)).then_with(|| self.by_total(a, b))
    }

    fn why_none_is_adequate(&self) -> String {
        if self.candidates.is_empty() {
            return "there is no candidate".to_owned();
        }
        let reason = |k: usize| self.rated[k].why_inadequate().map(|why| format!("{}: {why}", self.candidates[k].id));
        let reasons: Vec<String> = (0..self.candidates.len()).filter_map(reason).collect();
        format!("no candidate is adequate ({})", reasons.join("; "))
    }
}

#[cfg(test)]
mod tests;

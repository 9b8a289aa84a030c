//! What speaks for and against each candidate, in numbers: its criterion and the priors, as squared terms that a reader
//! can take off.

use crate::record::observation::ObservedWave;
use crate::selection::compared::{ComparedCandidate, Inadequacy, SelectionRules, TestEvent};
use crate::selection::evidence::{Evidence, SLOW_HZ};

/// Share of a record's root mean square that no lumped model of a vehicle describes below 60 Hz, at least. With 1 and
/// 4 % the pulses of docs/methods/prediction.md had the same errors.
const DISCREPANCY: f64 = 0.02;

/// Time that a term of the evidence stands for, s: a record of T seconds has 120 T terms below 60 Hz.
pub(crate) const TERM_S: f64 = 0.5 / SLOW_HZ;

/// What all candidates are compared with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComparedRecord {
    /// Root mean square of the record over the window, unit of the misfits.
    pub rms: f64,
    /// Standard deviation of the noise of the record below 60 Hz, as it was before the event, unit of the misfits; zero
    /// where it is not known.
    pub noise: f64,
    /// Restitution that the test shows.
    pub restitution: Option<f64>,
}

impl ComparedRecord {
    /// Of the first of its waves, with this noise below 60 Hz.
    pub fn of(wave: &ObservedWave, noise: f64) -> Self {
        Self { rms: wave.size(), noise, restitution: None }
    }

    /// Variance of a term that no model knows better: noise and the discrepancy of the best of them, at least what no
    /// lumped model describes.
    pub fn variance<'a>(&self, evidence: impl IntoIterator<Item = &'a Evidence>) -> f64 {
        let known = self.noise.powi(2) + (DISCREPANCY * self.rms).powi(2);
        let least = evidence.into_iter().filter_map(Evidence::least_variance).reduce(f64::min);
        least.unwrap_or(0.0).max(known * TERM_S)
    }
}

/// One candidate with what was counted.
#[derive(Debug, Clone, PartialEq)]
pub struct Rated {
    /// Why it is not adequate; empty: it is.
    pub inadequate: Vec<Inadequacy>,
    /// Whether it takes part in the choice: it is adequate, or no adequate one qualifies and it has the dynamic crush
    /// of the test.
    pub is_compared: bool,
    /// Root mean square misfit, unit of the record.
    pub misfit: Option<f64>,
    /// Score without priors, see `Evidence::score`.
    pub score: Option<f64>,
    /// The same above the lowest of the compared.
    pub difference: Option<f64>,
    /// What each prior adds.
    pub terms: Vec<(&'static str, f64)>,
    /// Score with priors above the lowest of the compared.
    pub difference_with_priors: Option<f64>,
    /// What it weighs in a prediction; zero: nothing.
    pub weight: f64,
    /// Standard deviations of the logarithms of its numbers, beside what no model describes.
    pub deviations: Vec<(String, f64)>,
}

impl Rated {
    /// The first reason why it is not adequate, as a sentence.
    pub fn why_inadequate(&self) -> Option<String> {
        self.inadequate.first().map(ToString::to_string)
    }

    /// Names of the events of its own test that it misses.
    pub fn missed_events(&self) -> Vec<String> {
        let missed = self.inadequate.iter().filter_map(|reason| match reason {
            Inadequacy::NeverStops => Some(TestEvent::Crush),
            Inadequacy::Misses { event, .. } => Some(*event),
            _ => None,
        });
        missed.map(|event| event.name().to_owned()).collect()
    }

    /// Whether its model describes the record.
    pub fn is_adequate(&self) -> bool {
        self.inadequate.is_empty()
    }
}

/// Rates the candidates, in their order, of which those take part whose inadequacies allow it; with the number of terms
/// that all were compared by, `None`: none is compared.
pub(super) fn rate_all(
    candidates: &[ComparedCandidate],
    record: &ComparedRecord,
    rules: &SelectionRules,
    takes_part: fn(&[Inadequacy]) -> bool,
) -> (Vec<Rated>, Option<usize>) {
    let mut rated: Vec<Rated> = candidates
        .iter()
        .zip(Inadequacy::of_all(candidates, rules))
        .map(|(candidate, inadequate)| Rated {
            is_compared: takes_part(&inadequate),
            inadequate,
            misfit: candidate.misfit,
            score: None,
            difference: None,
            terms: rules.terms(candidate, record.restitution),
            difference_with_priors: None,
            weight: 0.0,
            deviations: Vec::new(),
        })
        .collect();
    let compared = || candidates.iter().zip(&rated).filter(|(_, rated)| rated.is_compared).map(|(one, _)| one);
    let evidence = || compared().filter_map(|candidate| candidate.evidence.as_ref());
    let Some(terms) = evidence().map(|evidence| evidence.terms.len()).next() else { return (rated, None) };
    let variance = record.variance(evidence());
    for (candidate, rated) in candidates.iter().zip(&mut rated) {
        let Some(evidence) = &candidate.evidence else { continue };
        rated.score = evidence.score(variance);
        rated.deviations = evidence.deviations(variance);
    }
    let with_priors = |rated: &Rated| Some(rated.score? + rated.terms.iter().map(|(_, term)| term).sum::<f64>());
    let least = |of: &dyn Fn(&Rated) -> Option<f64>| {
        rated.iter().filter(|rated| rated.is_compared).filter_map(of).reduce(f64::min)
    };
    let (lowest, lowest_with_priors) = (least(&|rated| rated.score), least(&with_priors));
    for rated in &mut rated {
        rated.difference = rated.score.zip(lowest).map(|(score, lowest)| score - lowest);
        rated.difference_with_priors = with_priors(rated).zip(lowest_with_priors).map(|(total, lowest)| total - lowest);
    }
    (rated, Some(terms))
}

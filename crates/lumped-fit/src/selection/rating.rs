//! What speaks for and against each candidate, in numbers: its criterion and the priors, as squared terms that a reader
//! can take off.

use crate::record::sensor_noise::EXPLAINED;
use crate::selection::compared::{ComparedCandidate, Inadequacy, SelectionRules, TestEvent};
use crate::selection::evidence::{
    criterion, criterion_of_known_noise, fewest_samples, independent_samples, visible_misfit,
};

/// Misfits up to this factor above the least give the number of independent samples: a bad fit gains nothing by being
/// smooth.
const COMPARABLE: f64 = 1.1;

/// One wave of the compared record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComparedWave {
    /// Its samples: misfits of all waves stand one behind the other.
    pub samples: usize,
    /// Independent samples that its filter lets through at most; infinite where it is not known.
    pub most_independent: f64,
}

/// What all candidates are compared with.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedRecord {
    /// Root mean square of the record over the window, unit of the misfits.
    pub rms: f64,
    /// Its waves: every sensor of every test.
    pub waves: Vec<ComparedWave>,
    /// Standard deviation of the record's noise, as it was before the event; `None`: not known.
    pub noise: Option<f64>,
    /// Restitution that the test shows.
    pub restitution: Option<f64>,
}

impl ComparedRecord {
    /// Independent samples that its filters let through at most.
    fn most_samples(&self) -> f64 {
        self.waves.iter().map(|wave| wave.most_independent).sum()
    }

    /// Independent samples in a misfit: those of its waves, for what two sensors miss are two things.
    fn independent_samples(&self, misfit: &[f64]) -> f64 {
        let mut rest = misfit;
        let each = self.waves.iter().map(|wave| {
            let (of_wave, others) = rest.split_at(wave.samples.min(rest.len()));
            rest = others;
            independent_samples(of_wave, self.rms, wave.most_independent)
        });
        each.sum()
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
    /// Criterion without priors.
    pub aicc: Option<f64>,
    /// The same above the lowest of the compared.
    pub difference: Option<f64>,
    /// What each prior adds.
    pub terms: Vec<(&'static str, f64)>,
    /// Criterion with priors above the lowest of the compared.
    pub difference_with_priors: Option<f64>,
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

/// Rates the candidates, in their order, of which those take part whose inadequacies allow it; with the number of
/// independent samples that all were compared with, `None`: none is compared, and whether the noise before the event
/// explains the least misfit, so that its level is known.
pub(super) fn rate_all(
    candidates: &[ComparedCandidate],
    record: &ComparedRecord,
    rules: &SelectionRules,
    takes_part: fn(&[Inadequacy]) -> bool,
) -> (Vec<Rated>, Option<f64>, bool) {
    let mut rated: Vec<Rated> = candidates
        .iter()
        .zip(Inadequacy::of_all(candidates, rules))
        .map(|(candidate, inadequate)| Rated {
            is_compared: takes_part(&inadequate),
            inadequate,
            misfit: candidate.misfit.as_deref().and_then(rms),
            aicc: None,
            difference: None,
            terms: rules.terms(candidate, record.restitution),
            difference_with_priors: None,
        })
        .collect();
    let least = least_misfit(candidates, &rated, record);
    // Noise that explains the best misfit is a level that nobody has to estimate from misfits.
    let noise = record.noise.map(|noise| noise.hypot(visible_misfit(&[0.0], record.rms)));
    let noise = noise.filter(|noise| least.is_some_and(|least| least * least <= EXPLAINED * noise * noise));
    let noise = noise.filter(|_| record.most_samples().is_finite());
    let shared = || shared_samples(candidates, &rated, record, least?);
    let samples = if noise.is_some() { Some(record.most_samples()) } else { shared() };
    if let Some(samples) = samples {
        rate(candidates, &mut rated, record, (samples, noise));
    }
    (rated, samples, noise.is_some())
}

fn rms(misfit: &[f64]) -> Option<f64> {
    let mean_square = misfit.iter().map(|e| e * e).sum::<f64>() / misfit.len() as f64;
    Some(mean_square.sqrt()).filter(|rms| rms.is_finite())
}

/// The least misfit of a compared candidate, with what no sensor knows.
fn least_misfit(candidates: &[ComparedCandidate], rated: &[Rated], record: &ComparedRecord) -> Option<f64> {
    let compared = candidates.iter().zip(rated).filter(|(_, rated)| rated.is_compared);
    let misfits = compared.filter_map(|(candidate, _)| candidate.misfit.as_deref());
    misfits.map(|misfit| visible_misfit(misfit, record.rms)).reduce(f64::min)
}

/// The smallest number of independent samples among compared candidates with comparable misfits, at least as many as
/// the compared candidate with the fewest numbers needs: where a misfit is all zero level, all of it is worth one
/// sample, and there is still a choice among those.
fn shared_samples(
    candidates: &[ComparedCandidate],
    rated: &[Rated],
    record: &ComparedRecord,
    least: f64,
) -> Option<f64> {
    let compared = || candidates.iter().zip(rated).filter(|(_, rated)| rated.is_compared);
    let misfits: Vec<&[f64]> = compared().filter_map(|(candidate, _)| candidate.misfit.as_deref()).collect();
    let fewest = compared().map(|(candidate, _)| candidate.parameters).min()?;
    misfits
        .iter()
        .filter(|misfit| visible_misfit(misfit, record.rms) <= COMPARABLE * least)
        .map(|misfit| record.independent_samples(misfit))
        .reduce(f64::min)
        .map(|samples| samples.max(fewest_samples(fewest)))
}

/// Fills in the criteria.
fn rate(
    candidates: &[ComparedCandidate],
    rated: &mut [Rated],
    record: &ComparedRecord,
    (samples, noise): (f64, Option<f64>),
) {
    for (candidate, rated) in candidates.iter().zip(rated.iter_mut()) {
        let parameters = candidate.parameters;
        rated.aicc = match noise {
            Some(noise) => candidate
                .slow_misfit
                .as_deref()
                .and_then(|slow| criterion_of_known_noise(slow, record.rms, (samples, noise), parameters)),
            None => candidate.misfit.as_deref().and_then(|misfit| criterion(misfit, record.rms, samples, parameters)),
        };
    }
    let with_priors = |rated: &Rated| Some(rated.aicc? + rated.terms.iter().map(|(_, term)| term).sum::<f64>());
    let least = |of: &dyn Fn(&Rated) -> Option<f64>| {
        rated.iter().filter(|rated| rated.is_compared).filter_map(of).reduce(f64::min)
    };
    let (lowest, lowest_with_priors) = (least(&|rated| rated.aicc), least(&with_priors));
    for rated in rated.iter_mut() {
        rated.difference = rated.aicc.zip(lowest).map(|(aicc, lowest)| aicc - lowest);
        rated.difference_with_priors = with_priors(rated).zip(lowest_with_priors).map(|(total, lowest)| total - lowest);
    }
}

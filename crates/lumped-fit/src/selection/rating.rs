//! What speaks for and against each candidate, in numbers: whether it is adequate, its criterion, what priors add.

use crate::record::sensor_noise::EXPLAINED;
use crate::selection::compared_candidate::ComparedCandidate;
use crate::selection::evidence::{
    criterion, criterion_of_known_noise, fewest_samples, independent_samples, visible_misfit,
};
use crate::selection::prior::SelectionRules;

/// Misfits up to this factor above the least give the number of independent samples: a bad fit gains nothing by being
/// smooth.
const COMPARABLE: f64 = 1.1;

/// What all candidates are compared with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComparedRecord {
    /// Root mean square of the record over the window, unit of the misfits.
    pub rms: f64,
    /// Independent samples that its filter lets through at most; infinite where it is not known.
    pub most_samples: f64,
    /// Standard deviation of the record's noise, as it was before the event; `None`: not known.
    pub noise: Option<f64>,
    /// Restitution that the test shows.
    pub restitution: Option<f64>,
}

/// One candidate with what was counted.
#[derive(Debug, Clone, PartialEq)]
pub struct Rated {
    /// Why it is not adequate; `None`: it is.
    pub not_adequate: Option<String>,
    /// Root mean square misfit, unit of the record.
    pub misfit: Option<f64>,
    /// Criterion without priors.
    pub aicc: Option<f64>,
    /// The same above the lowest of the adequate.
    pub difference: Option<f64>,
    /// What each prior adds.
    pub terms: Vec<(&'static str, f64)>,
    /// Criterion with priors above the lowest of the adequate.
    pub difference_with_priors: Option<f64>,
}

impl Rated {
    pub(super) fn is_adequate(&self) -> bool {
        self.not_adequate.is_none()
    }
}

/// Rates the candidates, in their order; with the number of independent samples that all were compared with, `None`:
/// none is adequate, and whether the noise before the event explains the least misfit, so that its level is known.
pub(super) fn rate_all(
    candidates: &[ComparedCandidate],
    record: &ComparedRecord,
    rules: &SelectionRules,
) -> (Vec<Rated>, Option<f64>, bool) {
    let mut rated: Vec<Rated> = candidates
        .iter()
        .map(|candidate| Rated {
            not_adequate: not_adequate(candidate, rules),
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
    let noise = noise.filter(|_| record.most_samples.is_finite());
    let shared = || shared_samples(candidates, &rated, record, least?);
    let samples = if noise.is_some() { Some(record.most_samples) } else { shared() };
    if let Some(samples) = samples {
        rate(candidates, &mut rated, record, (samples, noise));
    }
    (rated, samples, noise.is_some())
}

fn rms(misfit: &[f64]) -> Option<f64> {
    let mean_square = misfit.iter().map(|e| e * e).sum::<f64>() / misfit.len() as f64;
    Some(mean_square.sqrt()).filter(|rms| rms.is_finite())
}

/// Why a candidate is not adequate.
fn not_adequate(candidate: &ComparedCandidate, rules: &SelectionRules) -> Option<String> {
    if !candidate.physical {
        return Some("it is no passive structure".to_owned());
    }
    if !candidate.on_bound.is_empty() {
        return Some(format!("on a bound of its search: {}", candidate.on_bound.join(", ")));
    }
    let (crush, limit) = (100.0 * candidate.crush_error.unwrap_or(f64::INFINITY), rules.crush_limit_percent);
    if crush > limit {
        return Some(format!("it misses the dynamic crush of a test by {crush:.1} %, more than {limit} %"));
    }
    let limit = rules.adequate_fit_percent;
    match candidate.fit_percent {
        Some(fit) if fit >= limit => candidate.misfit.is_none().then(|| "it has no response to compare".to_owned()),
        Some(fit) => Some(format!("its displacement fit of {fit:.1} % is below {limit} %")),
        None => Some("it has no displacement to compare".to_owned()),
    }
}

/// The least misfit of an adequate candidate, with what no sensor knows.
fn least_misfit(candidates: &[ComparedCandidate], rated: &[Rated], record: &ComparedRecord) -> Option<f64> {
    let adequate = candidates.iter().zip(rated).filter(|(_, rated)| rated.is_adequate());
    let misfits = adequate.filter_map(|(candidate, _)| candidate.misfit.as_deref());
    misfits.map(|misfit| visible_misfit(misfit, record.rms)).reduce(f64::min)
}

/// The smallest number of independent samples among adequate candidates with comparable misfits, at least as many as
/// the adequate candidate with the fewest numbers needs: where a misfit is all zero level, all of it is worth one
/// sample, and there is still a choice among those.
fn shared_samples(
    candidates: &[ComparedCandidate],
    rated: &[Rated],
    record: &ComparedRecord,
    least: f64,
) -> Option<f64> {
    let adequate = || candidates.iter().zip(rated).filter(|(_, rated)| rated.is_adequate());
    let misfits: Vec<&[f64]> = adequate().filter_map(|(candidate, _)| candidate.misfit.as_deref()).collect();
    let fewest = adequate().map(|(candidate, _)| candidate.parameters).min()?;
    misfits
        .iter()
        .filter(|misfit| visible_misfit(misfit, record.rms) <= COMPARABLE * least)
        .map(|misfit| independent_samples(misfit, record.rms, record.most_samples))
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
        let misfit = candidate.misfit.as_deref();
        let parameters = candidate.parameters;
        rated.aicc = misfit.and_then(|misfit| match noise {
            Some(noise) => criterion_of_known_noise(misfit, record.rms, (samples, noise), parameters),
            None => criterion(misfit, record.rms, samples, parameters),
        });
    }
    let with_priors = |rated: &Rated| Some(rated.aicc? + rated.terms.iter().map(|(_, term)| term).sum::<f64>());
    let least = |of: &dyn Fn(&Rated) -> Option<f64>| {
        rated.iter().filter(|rated| rated.is_adequate()).filter_map(of).reduce(f64::min)
    };
    let (lowest, lowest_with_priors) = (least(&|rated| rated.aicc), least(&with_priors));
    for rated in rated.iter_mut() {
        rated.difference = rated.aicc.zip(lowest).map(|(aicc, lowest)| aicc - lowest);
        rated.difference_with_priors = with_priors(rated).zip(lowest_with_priors).map(|(total, lowest)| total - lowest);
    }
}

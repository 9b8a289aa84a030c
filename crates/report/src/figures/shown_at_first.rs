//! Which candidates a figure of many shows at first; the others wait in its legend.

use std::collections::BTreeSet;

use crate::findings::{
    CandidateResult, Ranking,
    ranking::{AS_GOOD_PERCENT, is_preferred},
};

/// Of candidates in the order of their rank the ids of those shown at first: the best, and up to `count` in all.
///
/// Those without a parameter on a bound of the search other than zero go before the rest, if they explain half of the
/// displacement. Of several parameter sets of one model that fit alike (within 0.1 percentage points, as for the best
/// model) the first stands for all: their curves lie on each other. Chains that a person stated are shown beyond the
/// count.
pub fn at_first<'a>(ranked: &[&'a CandidateResult], ranking: &Ranking, count: usize) -> BTreeSet<&'a str> {
    let mut order = ranked.to_vec();
    // Stable: the rank decides among equals.
    order.sort_by_key(|candidate| (ranking.best.as_deref() != Some(&candidate.id), !is_preferred(candidate)));
    let mut shown: Vec<&CandidateResult> = Vec::new();
    for candidate in order {
        let alike = shown.iter().any(|other| model(other) == model(candidate) && fit_alike(other, candidate));
        if !alike && (shown.len() < count || candidate.is_chain()) {
            shown.push(candidate);
        }
    }
    shown.into_iter().map(|candidate| candidate.id.as_str()).collect()
}

fn fit(candidate: &CandidateResult) -> Option<f64> {
    candidate.fit_percent()
}

/// Two chains are two models.
fn model(candidate: &CandidateResult) -> (&str, &str) {
    let name = if candidate.is_chain() { candidate.record.method.as_str() } else { "" };
    (&candidate.record.model, name)
}

fn fit_alike(a: &CandidateResult, b: &CandidateResult) -> bool {
    fit(a).zip(fit(b)).is_some_and(|(a, b)| (a - b).abs() <= AS_GOOD_PERCENT)
}

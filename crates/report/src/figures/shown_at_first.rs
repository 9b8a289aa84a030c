//! Which candidates a figure of many shows at first; the others wait in its legend.

use std::collections::BTreeSet;

use crate::findings::{CandidateResult, Ranking, same_curve};

/// Of candidates in the order of their rank the ids of those shown at first: the recommended, and up to `count` in all.
///
/// Of several with one curve the first stands for all. Chains that a person stated are shown beyond the count.
pub fn at_first<'a>(ranked: &[&'a CandidateResult], ranking: &Ranking, count: usize) -> BTreeSet<&'a str> {
    let mut order = ranked.to_vec();
    // Stable: the rank decides among the others.
    order.sort_by_key(|candidate| ranking.best.as_deref() != Some(&candidate.id));
    let mut shown: Vec<&CandidateResult> = Vec::new();
    for candidate in order {
        let alike = shown.iter().any(|other| same_curve(other, candidate));
        if candidate.is_chain() || !alike && shown.len() < count {
            shown.push(candidate);
        }
    }
    shown.into_iter().map(|candidate| candidate.id.as_str()).collect()
}

//! Which candidate stands before which.

use std::cmp::Ordering;

use crate::Candidate;

/// Candidate ids from the best displacement fit to the worst.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Ranking {
    /// Every candidate with a fit, physical or not, best first.
    pub order: Vec<String>,
    /// The physical candidate with the best fit.
    pub best: Option<String>,
}

impl Ranking {
    /// Ranks by `fit_percent` of the simulation: the displacement fit over the window that was compared, by default the
    /// loading phase.
    ///
    /// Equal fits, such as those of a parameter set and its dual, stand in [id order](id_key). Candidates without a fit
    /// are left out; only a physical one (every parameter positive) can be the best.
    pub fn of(candidates: &[Candidate]) -> Self {
        let mut fitted: Vec<(f64, &Candidate)> = candidates
            .iter()
            .filter_map(|candidate| Some((candidate.simulation.as_ref()?.fit_percent?, candidate)))
            .filter(|(fit, _)| !fit.is_nan())
            .collect();
        fitted.sort_by(|(fit_a, a), (fit_b, b)| fit_b.total_cmp(fit_a).then_with(|| by_id(&a.id, &b.id)));
        Self {
            order: fitted.iter().map(|(_, candidate)| candidate.id.clone()).collect(),
            best: fitted.iter().find(|(_, c)| c.record.physical).map(|(_, c)| c.id.clone()),
        }
    }

    /// Place of a candidate, counted from 1.
    pub fn place(&self, id: &str) -> Option<usize> {
        self.order.iter().position(|other| other == id).map(|index| index + 1)
    }
}

/// Sort key of a candidate id: its parts, the last as a number where it is one, so that `.../10` comes after `.../2`.
pub fn id_key(id: &str) -> (&str, u64, &str) {
    match id.rsplit_once('/') {
        Some((family, index)) => (family, index.parse().unwrap_or(u64::MAX), index),
        None => (id, u64::MAX, ""),
    }
}

/// Compares two candidate ids by [`id_key`].
pub fn by_id(a: &str, b: &str) -> Ordering {
    id_key(a).cmp(&id_key(b))
}

/// For each candidate the index of the one that stands for it in a drawing: itself, or an earlier candidate that
/// gives exactly the same record (`equivalent_to`, in either direction).
pub fn pairs_of_equals(candidates: &[Candidate]) -> Vec<usize> {
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
    use super::*;

    #[test]
    fn an_index_is_compared_as_a_number() {
        assert_eq!(by_id("kelvin/closed-form/10", "kelvin/closed-form/2"), Ordering::Greater);
        assert_eq!(by_id("elastoplastic/closed-form/1", "kelvin/closed-form/1"), Ordering::Less);
    }
}

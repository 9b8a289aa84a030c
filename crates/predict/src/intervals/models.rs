//! The adequate models of a test and their weights: what another model would say is part of what is not known.

use std::collections::BTreeMap;

use crumple_lumped_fit::EnergyClass;

use crate::impact::candidate::Candidate;

/// Models that count at most.
const MOST: usize = 5;
/// Least weight of the best model of each class of adequate models: no test of one speed tells the classes apart for
/// sure.
const LEAST_OF_CLASS: f64 = 0.05;

/// Places of models and their weights, which sum to 1; none where no model is adequate.
///
/// Weights are `exp(-d/2)` of the difference `d` of the criterion with priors (Akaike weights: Burnham & Anderson 2002,
/// section 2.9), of the five best, and at least 0.05 for the best of each class.
pub fn weights(candidates: &[Candidate]) -> Vec<(usize, f64)> {
    let mut adequate: Vec<(usize, f64)> =
        candidates.iter().enumerate().filter_map(|(k, candidate)| Some((k, candidate.difference?))).collect();
    adequate.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    let mut best_of_class: BTreeMap<EnergyClass, usize> = BTreeMap::new();
    for (k, _) in &adequate {
        best_of_class.entry(candidates[*k].class()).or_insert(*k);
    }
    let is_best = |k: usize| best_of_class.values().any(|best| *best == k);
    let counted = adequate.iter().enumerate().filter(|(place, (k, _))| *place < MOST || is_best(*k));
    let counted: Vec<(usize, f64)> = counted.map(|(_, (k, difference))| (*k, (-0.5 * difference).exp())).collect();
    let sum: f64 = counted.iter().map(|(_, weight)| weight).sum();
    let floored: Vec<(usize, f64)> = counted
        .into_iter()
        .map(|(k, weight)| (k, if is_best(k) { (weight / sum).max(LEAST_OF_CLASS) } else { weight / sum }))
        .collect();
    let sum: f64 = floored.iter().map(|(_, weight)| weight).sum();
    floored.into_iter().map(|(k, weight)| (k, weight / sum)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(model: &str, difference: Option<f64>) -> Candidate {
        Candidate {
            id: format!("{model}/direct-fit/1"),
            model: model.to_owned(),
            parameters: [("damping_n_s_per_m".to_owned(), 1.0)].into(),
            spread: None,
            difference,
        }
    }

    #[test]
    fn the_best_of_each_class_has_a_say() {
        let all = [
            candidate("kelvin", Some(0.0)),
            candidate("elastoplastic", Some(40.0)),
            candidate("maxwell", Some(2.0)),
            candidate("maxwell", None),
        ];
        let weights = weights(&all);
        assert_eq!(weights.iter().map(|(k, _)| *k).collect::<Vec<_>>(), [0, 2, 1]);
        // exp(-1) beside 1, and 0.05 of the sum before it was scaled.
        assert!((weights[1].1 / weights[0].1 - (-1.0_f64).exp()).abs() < 1e-6, "{weights:?}");
        assert!((weights[2].1 - 0.05 / 1.05).abs() < 1e-6, "{weights:?}");
        assert!((weights.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(super::weights(&all[3..]).is_empty());
    }
}

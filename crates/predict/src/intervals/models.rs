//! The adequate models of a test and their weights: what another model would say is part of what is not known.

use std::collections::BTreeMap;

use crumple_lumped_fit::EnergyClass;

use crate::impact::candidate::Candidate;

/// Models that count at most.
const MOST: usize = 5;
/// Least weight of the best model of each class of adequate models, unless the record is decisive: no test of one speed
/// tells the classes apart for sure.
const LEAST_OF_CLASS: f64 = 0.05;
/// By so much may the independent samples of a misfit be counted too high: a class keeps the weight that it would have
/// with so many times fewer, if that is less.
const FEWER_SAMPLES: f64 = 4.0;

/// Places of models and their weights, which sum to 1; none where no model is adequate.
///
/// Weights are `exp(-d/2)` of the difference `d` of the criterion with priors (Akaike weights: Burnham & Anderson 2002,
/// section 2.9), of the five best, and at least 0.05 or `exp(-d/8)` for the best of each class, whichever is less.
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
    let counted: Vec<(usize, f64)> = counted.map(|(_, (k, difference))| (*k, *difference)).collect();
    let weight = |difference: f64| (-0.5 * difference).exp();
    let sum: f64 = counted.iter().map(|(_, difference)| weight(*difference)).sum();
    let least = |difference: f64| LEAST_OF_CLASS.min((-0.5 * difference / FEWER_SAMPLES).exp());
    let floored: Vec<(usize, f64)> = counted
        .into_iter()
        .map(|(k, difference)| {
            let weight = weight(difference) / sum;
            (k, if is_best(k) { weight.max(least(difference)) } else { weight })
        })
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
            candidate("elastoplastic", Some(20.0)),
            candidate("maxwell", Some(2.0)),
            candidate("maxwell", None),
        ];
        let weights = weights(&all);
        assert_eq!(weights.iter().map(|(k, _)| *k).collect::<Vec<_>>(), [0, 2, 1]);
        // exp(-1) beside 1, and 0.05 of the sum before it was scaled; its own share was exp(-10).
        assert!((weights[1].1 / weights[0].1 - (-1.0_f64).exp()).abs() < 1e-6, "{weights:?}");
        assert!((weights[2].1 - 0.05 / 1.05).abs() < 1e-4, "{weights:?}");
        assert!((weights.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(super::weights(&all[3..]).is_empty());
        // A record that is decisive, exp(-60/8) even with a quarter of the samples, leaves the other class hardly any.
        let decided = super::weights(&[candidate("kelvin", Some(0.0)), candidate("elastoplastic", Some(60.0))]);
        assert!((decided[1].1 / decided[0].1 - (-7.5_f64).exp()).abs() < 1e-9, "{decided:?}");
    }
}

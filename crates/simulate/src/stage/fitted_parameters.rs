//! How many numbers of a candidate were chosen to meet the record.

use crumple_lumped::{Model, ModelKind, ParameterKind, parameter_kind};
use crumple_simulate::{numbers_of, parameters_of};
use crumple_stage::records::CandidateV1;

/// Numbers that the fit was free to choose, or the person who stated a chain.
///
/// Of a model by name: its springs, dampers and knots. Of a fitted chain: what its record says was free (an interval, a
/// place in the correlation, or a bound it stopped on), without a mass that is the rest of the total. Of a stated
/// chain, and of a fitted one that says nothing of it: all springs, dampers and knots.
pub fn fitted_parameters(candidate: &CandidateV1) -> u32 {
    if let Ok(kind) = candidate.model.parse::<ModelKind>() {
        // Of the knots of a crushed structure those it has.
        let model = Model::from_parameters(kind, &candidate.parameters);
        return model.map_or_else(|_| parameters_of(kind), |model| numbers_of(&model));
    }
    let names = || candidate.parameters.keys();
    let is_mass = |name: &str| parameter_kind(&candidate.model, name) == Some(ParameterKind::Mass);
    let Some(known) = &candidate.uncertainty else {
        return names().filter(|name| !is_mass(name)).count() as u32;
    };
    let on_bound = candidate.fit.as_ref().map_or(&[][..], |fit| &fit.active_bounds);
    let free = |name: &&String| {
        let fitted = known.order.contains(name) || on_bound.contains(name);
        // A mass with an interval and nothing else follows from the total.
        fitted || (!is_mass(name) && known.interval_low.contains_key(*name))
    };
    names().filter(free).count() as u32
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use crumple_stage::records::{FitV1, UncertaintyV1};

    use super::*;

    const NAMES: [&str; 6] = ["m1_kg", "k1_n_per_m", "c1_n_s_per_m", "m2_kg", "k2_n_per_m", "c2_n_s_per_m"];

    fn stated() -> CandidateV1 {
        CandidateV1 {
            model: "chain".to_owned(),
            method: "car".to_owned(),
            parameters: NAMES.iter().map(|name| ((*name).to_owned(), 1.0)).collect(),
            physical: true,
            equivalent_to: None,
            fit: None,
            uncertainty: None,
            notes: vec![],
        }
    }

    /// A chain of which m1, k1 and k2 were free, k2 stopped on a bound and m2 is the rest.
    fn fitted() -> CandidateV1 {
        let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<String>>();
        let interval: BTreeMap<String, Option<f64>> =
            names(&["m1_kg", "k1_n_per_m", "k2_n_per_m", "m2_kg"]).into_iter().map(|name| (name, Some(1.0))).collect();
        CandidateV1 {
            fit: Some(FitV1 {
                channel: "103".to_owned(),
                quantity: "displacement".to_owned(),
                from_s: 0.0,
                to_s: 0.08,
                samples: 250,
                rmse: 1e-3,
                iterations: 9,
                evaluations: 90,
                stop_reason: "cost-converged".to_owned(),
                active_bounds: names(&["k2_n_per_m"]),
                sensors: vec![],
            }),
            uncertainty: Some(UncertaintyV1 {
                order: names(&["m1_kg", "k1_n_per_m"]),
                interval_low: interval.clone(),
                interval_high: interval,
                ..UncertaintyV1::default()
            }),
            ..stated()
        }
    }

    #[test]
    fn only_what_was_free_of_a_fitted_chain_is_counted() {
        assert_eq!(fitted_parameters(&fitted()), 3);
    }

    #[test]
    fn what_a_person_stated_was_chosen_by_a_person() {
        assert_eq!(fitted_parameters(&stated()), 4);
        assert_eq!(fitted_parameters(&CandidateV1 { uncertainty: None, ..fitted() }), 4);
    }

    #[test]
    fn a_model_by_name_counts_as_ever() {
        assert_eq!(fitted_parameters(&CandidateV1 { model: "kelvin".to_owned(), ..stated() }), 2);
    }
}

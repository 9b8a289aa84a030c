//! A candidate replaced by the minimum of its misfit through the filter, and the weights of several sensors there.

use crumple_lumped::{Model, ParameterKind};
use crumple_lumped_fit::{
    Candidate, CandidateNote, NoteTopic, Observation, Refined, bounds_remark, errors_in_words, mass_of, note_of_errors,
};

/// Rounds of weighing sensors, and the change of a weight that is worth another one.
pub const WEIGHINGS: usize = 4;
const WORTH_ANOTHER: f64 = 0.01;

/// Weighs the waves by the root mean square misfit of each; whether that changed anything.
pub fn weigh(observed: &mut Observation, refined: &Refined) -> bool {
    observed.weigh(&observed.rmse(&refined.misfit_m), WORTH_ANOTHER)
}

/// A damper of a chain below this share of `M/T`, of the mass and the window of a fit, stands for none: the least that
/// searches in logarithms reach is 1e-5 of it.
const NO_DAMPER: f64 = 1e-4;

/// Parameters that the search left on a bound other than zero: that value is the bound's, so it is fixed in the
/// refinement and has no interval. A damper of a chain of masses (the Kelvin model is one) on its lower bound is not
/// fixed: it goes to zero.
pub fn fixed_at_bound(candidate: &Candidate) -> impl Iterator<Item = &'static str> {
    let values = candidate.model.parameters();
    let kind = candidate.model.kind();
    let mass_kg = mass_of(&candidate.model);
    let window_s = candidate.fit.as_ref().map_or(f64::INFINITY, |fit| fit.to_s);
    let names = candidate.fit.as_ref().map_or(&[][..], |fit| &fit.active_bounds);
    let is_chain = matches!(
        candidate.model,
        Model::Kelvin(_) | Model::DoubleSpringMassDamper(_) | Model::TripleSpringMassDamper(_)
    );
    let least = if is_chain { NO_DAMPER * mass_kg / window_s } else { 0.0 };
    let is_damper = move |name: &str| kind.parameter(name).is_some_and(|p| p.kind == ParameterKind::Damping);
    let nothing = move |name: &str| if is_damper(name) { least } else { 0.0 };
    names.iter().copied().filter(move |name| values.get(*name).is_some_and(|value| *value > nothing(name)))
}

/// Replaces the values of a fit by those of the refined minimum, with its errors, counts and notes.
pub fn replace_by_refined(candidate: &mut Candidate, observed: &Observation, refined: &Refined) {
    candidate.model = refined.model;
    if let Some(fit) = &mut candidate.fit {
        let rmse = observed.rmse(&refined.misfit_m);
        fit.rmse = rmse.first().copied().unwrap_or(fit.rmse);
        let noise = observed.noise_levels(&rmse).first().copied().unwrap_or(0.0);
        for ((sensor, rmse), wave) in fit.sensors.iter_mut().zip(&rmse).zip(&observed.waves) {
            sensor.rmse = *rmse;
            sensor.noise = noise / wave.weight;
        }
        let errors = fit.sensors.iter().map(|s| (s.rmse, s.quantity, s.channel.as_str(), format!("mass {}", s.mass)));
        let errors = note_of_errors(&errors_in_words(errors), Some("through the filter"));
        for note in candidate.notes.iter_mut().filter(|note| note.topic == NoteTopic::SensorErrors) {
            note.note.text.clone_from(&errors);
        }
        fit.iterations += refined.iterations;
        fit.evaluations += refined.evaluations;
        fit.stop_reason = refined.stop_reason;
        // What was fixed stays named; a parameter may have left zero.
        fit.active_bounds.retain(|name| refined.free.iter().all(|p| p.name != *name));
        let stopped = refined
            .free
            .iter()
            .zip(&refined.on_bound)
            .filter(|(_, fixed_at_bound)| **fixed_at_bound)
            .map(|(p, _)| p.name);
        fit.active_bounds.extend(stopped);
        candidate.notes.retain(|note| note.topic != NoteTopic::ActiveBounds);
        let bounds = bounds_remark(&candidate.model, &fit.active_bounds);
        candidate.notes.extend(bounds.map(CandidateNote::active_bounds));
    }
}

#[cfg(test)]
mod tests {
    use crumple_lumped::{Kelvin, Maxwell};
    use crumple_lumped_fit::{Fit, FitQuantity, Method, StopReason};

    use super::*;

    fn on_bounds(model: Model) -> Candidate {
        let fit = Fit {
            from_s: 0.0,
            to_s: 0.1,
            samples: 100,
            quantity: FitQuantity::Displacement,
            rmse: 0.0,
            iterations: 1,
            evaluations: 1,
            stop_reason: StopReason::CostConverged,
            active_bounds: vec!["stiffness_n_per_m", "damping_n_s_per_m"],
            sensors: Vec::new(),
        };
        let method = Method::DirectFit;
        Candidate { model, method, index: 1, equivalent_to: None, fit: Some(fit), uncertainty: None, notes: Vec::new() }
    }

    #[test]
    fn a_damper_at_nothing_is_free_to_be_zero_and_a_large_one_is_held() {
        // 1e-4 of 1000 kg over 0.1 s is 1 N s/m.
        let kelvin =
            |c: f64| on_bounds(Model::Kelvin(Kelvin { mass_kg: 1e3, stiffness_n_per_m: 1e5, damping_n_s_per_m: c }));
        let both = ["stiffness_n_per_m", "damping_n_s_per_m"];
        assert_eq!(fixed_at_bound(&kelvin(0.1)).collect::<Vec<_>>(), both[..1]);
        assert_eq!(fixed_at_bound(&kelvin(10.0)).collect::<Vec<_>>(), both);
        // In series a damper of nothing is no model.
        let maxwell = Maxwell { mass_kg: 1e3, stiffness_n_per_m: 1e5, damping_n_s_per_m: 0.1 };
        assert_eq!(fixed_at_bound(&on_bounds(Model::Maxwell(maxwell))).collect::<Vec<_>>(), both);
    }
}

//! The least misfit of a model to a record near its fit to another: of the acceleration near a fit to the
//! displacement.

use crumple_estimation::minimise::levenberg_marquardt::{Bounds, descend};
use crumple_lumped::{Model, ParameterKind};

use crate::fit::as_measured::near;
use crate::free::coordinates::Coordinates;
use crate::free::free_parameter::free_parameters;
use crate::record::observation::Observation;

/// Relative decrease of the sum of squares that is worth another step, and another twenty: of some 20 independent
/// samples in units of the noise, a hundredth is a fifth of a criterion.
const WORTH_A_STEP: f64 = 1e-4;
const WORTH_TWENTY_STEPS: f64 = 1e-2;

/// A model where it meets a record best.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastMisfit {
    /// Model less record as measured, at every sample.
    pub misfit: Vec<f64>,
    /// Springs and dampers that stand on no bound there.
    pub inside: Vec<&'static str>,
}

/// The least misfit of a model of springs and dampers that a descent from its values finds; masses stay.
///
/// `on_bound`: parameters that a bound of a search holds: they start at the scale of their kind ([`free_parameters`],
/// which takes it from `crush_m`), for a descent does not find back from a value that is rigid or without effect.
/// `None` for a model with knots, which has a minimum for each place of them, and where there is no finite response.
pub fn least_misfit(model: &Model, on_bound: &[String], observed: &Observation, crush_m: f64) -> Option<LeastMisfit> {
    let mut free = free_parameters(model, observed.impact_speed_m_per_s, crush_m);
    if free.iter().any(|p| !matches!(p.kind, ParameterKind::Stiffness | ParameterKind::Damping)) {
        return None;
    }
    let mut values = model.parameters();
    for parameter in free.iter_mut().filter(|p| p.value > 0.0 && on_bound.iter().any(|name| name == p.name)) {
        values.insert(parameter.name.to_owned(), parameter.scale);
        *parameter = parameter.described_at(parameter.scale);
    }
    let coordinates = Coordinates::near(Model::from_parameters(model.kind(), &values).ok()?, &free);
    let problem = near(&coordinates, observed);
    let bounds = Bounds { cost_tolerance: WORTH_A_STEP, slow: WORTH_TWENTY_STEPS, ..problem.bounds() };
    let least = descend(&problem, &coordinates.start(), &bounds)?;
    let misfit = observed.misfit_of(&coordinates.model(&least.theta)?.structure().ok()?)?;
    let inside = free.iter().zip(&least.on_bound).filter(|(_, on_bound)| !**on_bound).map(|(p, _)| p.name);
    Some(LeastMisfit { misfit, inside: inside.collect() })
}

#[cfg(test)]
mod tests {
    use crumple_lumped::{DoubleSpringMassDamper, Nonlinear1};
    use crumple_signal::{Acceleration, Signal};

    use super::*;
    use crate::{FitQuantity, Measurement, ObservedWave};

    const IMPACT_SPEED_M_PER_S: f64 = 13.4;
    const CRUSH_M: f64 = 0.6;
    const SAMPLES: usize = 700;

    /// The acceleration of the compartment, exact.
    fn recorded(truth: &Model) -> Observation {
        let response = truth.respond(IMPACT_SPEED_M_PER_S, 1e-4, SAMPLES).unwrap();
        let acceleration = response.motions.last().unwrap().acceleration_m_per_s2.clone();
        let record = Signal::<Acceleration>::new(0.0, 1e-4, acceleration).unwrap();
        let measurement = Measurement::of_samples(&record, 0.0);
        let what = (None, FitQuantity::Acceleration);
        let wave = ObservedWave::new(&record, what, 0.0, measurement, (0.0, 0.06), usize::MAX).unwrap();
        Observation { impact_speed_m_per_s: IMPACT_SPEED_M_PER_S, waves: vec![wave] }
    }

    #[test]
    fn a_spring_that_a_search_left_on_its_bound_is_found_inside() {
        let truth = DoubleSpringMassDamper {
            m1_kg: 300.0,
            m2_kg: 900.0,
            k1_n_per_m: 9e5,
            c1_n_s_per_m: 4e3,
            k2_n_per_m: 1.2e6,
            c2_n_s_per_m: 9e3,
        };
        let observed = recorded(&Model::DoubleSpringMassDamper(truth));
        let stiff = Model::DoubleSpringMassDamper(DoubleSpringMassDamper { k2_n_per_m: 1e10, ..truth });
        let least = least_misfit(&stiff, &["k2_n_per_m".to_owned()], &observed, CRUSH_M).unwrap();
        assert_eq!(least.inside.len(), 4, "{:?}", least.inside);
        // A hundredth of the peak of 270 m/s²: where steps stop being worth it, not rounding.
        let largest = least.misfit.iter().fold(0.0_f64, |largest, e| largest.max(e.abs()));
        assert!(largest < 2.7, "{largest}");
    }

    #[test]
    fn a_model_with_knots_has_no_least_misfit_here() {
        let model = Model::Nonlinear1(Nonlinear1 {
            mass_kg: 1200.0,
            k1_n_per_m: 2.4e5,
            k2_n_per_m: 4.8e5,
            c1_n_s_per_m: 9e3,
            c2_n_s_per_m: 4e3,
            c3_n_s_per_m: 1.5e3,
            v_thresh_m_per_s: 5.0,
            crush_m: CRUSH_M,
            v0_m_per_s: IMPACT_SPEED_M_PER_S,
        });
        assert_eq!(least_misfit(&model, &[], &recorded(&model), CRUSH_M), None);
    }
}

//! A parameter set with the record of how it was fitted.
//!
//! A [`Candidate`] is one answer for one model by one method. A record can have several: dual models, other minima,
//! other roots of a polynomial. They are numbered by `index`, and none is left out because another fits as well.

use std::collections::BTreeMap;

use crumple_lumped::{Model, ParameterKind};
use crumple_numerics::estimation::minimise::StopReason;
use crumple_signal::Note;

use crate::candidate::minimum::Minimum;
use crate::candidate::parameter_words::all_in_words;
use crate::free::free_parameter::mass_of;
use crate::{FitQuantity, Method, Observation, ObservedWave, SensorFit};

/// One set of parameters, with how it was found and what was assumed.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// The model with its parameters.
    pub model: Model,
    /// How they were found.
    pub method: Method,
    /// Place among the solutions of this model and method, from 1.
    pub index: usize,
    /// Index of another solution of the same model and method that gives exactly the same record.
    pub equivalent_to: Option<usize>,
    /// How it was fitted; `None` for a closed form.
    pub fit: Option<Fit>,
    /// Standard deviations that the method brings along, such as those of matched coefficients.
    pub uncertainty: Option<Uncertainty>,
    /// The minimum of the misfit as measured at these values, or nearest to them: what they are assessed by. `None`
    /// without a record.
    pub minimum: Option<Minimum>,
    /// Reductions and assumptions, in words.
    pub notes: Vec<Note>,
}

impl Candidate {
    /// Number `index` of these parameters, without a fit or an equivalent.
    pub fn new(model: Model, method: Method, index: usize, notes: Vec<Note>) -> Self {
        Self { model, method, index, equivalent_to: None, fit: None, uncertainty: None, minimum: None, notes }
    }

    /// `<model>/<method>/<index>`.
    pub fn id(&self) -> String {
        self.id_of(self.index)
    }

    /// Id of the candidate it is equivalent to.
    pub fn equivalent_id(&self) -> Option<String> {
        self.equivalent_to.map(|index| self.id_of(index))
    }

    /// Whether the values are those of a fit at its minimum, and not only near one.
    pub fn is_at_minimum(&self) -> bool {
        self.fit.is_some() && self.minimum.as_ref().is_some_and(|minimum| minimum.model == self.model)
    }

    /// Fitted to something else than the displacement of the pulse.
    pub fn is_of_sensors(&self) -> bool {
        self.fit.as_ref().is_some_and(|fit| fit.quantity != FitQuantity::Displacement || !fit.sensors.is_empty())
    }

    /// Parameters that the fit left on a bound of the search.
    pub fn fixed_at_bound(&self) -> Vec<&'static str> {
        self.fit.as_ref().map_or_else(Vec::new, |fit| fixed_at_bound(&self.model, &fit.active_bounds, fit.to_s))
    }

    fn id_of(&self, index: usize) -> String {
        format!("{}/{}/{index}", self.model.kind(), self.method)
    }
}

/// Record of a fit by iteration; parameters are named by `N`.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit<N = &'static str> {
    /// Window, s after time zero.
    pub from_s: f64,
    /// End of the window: time of the last sample used.
    pub to_s: f64,
    /// Samples used.
    pub samples: usize,
    /// What was fitted.
    pub quantity: FitQuantity,
    /// Root mean square error over them, unit of the quantity; of several sensors that of the first.
    pub rmse: f64,
    /// Iterations of the descent that ended here, on the thinned and on the whole window.
    pub iterations: u32,
    /// Model evaluations of all starts.
    pub evaluations: u64,
    /// Why the best start stopped.
    pub stop_reason: StopReason,
    /// Names of the parameters that stopped on a bound.
    pub active_bounds: Vec<N>,
    /// How far each sensor was missed; none where the compartment's displacement alone was fitted.
    pub sensors: Vec<SensorFit>,
}

impl<N> Fit<N> {
    /// The record of a fit to waves with these root mean square errors, each in its unit. `sensors`: channel and number
    /// of the mass of each wave, none where they are not told apart; `descent`: iterations, evaluations and why it
    /// stopped.
    pub(crate) fn of_waves(
        observed: &Observation,
        rmse: &[f64],
        sensors: Vec<(String, usize)>,
        descent: (u32, u64, StopReason),
        active_bounds: Vec<N>,
    ) -> Self {
        let (first, level) = (&observed.waves[0], observed.noise_levels(rmse)[0]);
        let sensor = |(((channel, mass), rmse), wave): (((String, usize), &f64), &ObservedWave)| SensorFit {
            channel,
            mass,
            quantity: wave.quantity,
            rmse: *rmse,
            noise: level / wave.weight,
        };
        let (iterations, evaluations, stop_reason) = descent;
        Self {
            from_s: first.time_s(0),
            to_s: first.time_s(first.samples.len() - 1),
            samples: observed.rows(),
            quantity: first.quantity,
            rmse: rmse[0],
            iterations,
            evaluations,
            stop_reason,
            active_bounds,
            sensors: sensors.into_iter().zip(rmse).zip(&observed.waves).map(sensor).collect(),
        }
    }
}

/// Standard deviations to first order that a method brings along.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// What it was made from, in words.
    pub method: &'static str,
    /// Standard deviation by parameter, in its unit; a parameter on a bound has none.
    pub standard_deviation: BTreeMap<&'static str, f64>,
    /// Condition number of the sensitivity matrix, columns scaled to one length.
    pub condition: f64,
    /// Lag-1 autocorrelation of the residuals that entered; `None` where none did.
    pub residual_autocorrelation: Option<f64>,
}

/// The note on parameters that stopped on a bound; `None` where none did.
///
/// Zero is the limit of what is physical, and an answer: a damper of zero is a spring alone. Any other bound is that
/// of the search: the value is the bound's and nothing of the record.
pub fn bounds_remark(model: &Model, active_bounds: &[&'static str]) -> Option<String> {
    let values = model.parameters();
    let (zero, other): (Vec<&str>, Vec<&str>) =
        active_bounds.iter().partition(|name| values.get(**name).is_some_and(|value| *value == 0.0));
    let zero = (!zero.is_empty()).then(|| format!("zero, the smallest value possible: {}", all_in_words(model, zero)));
    let other = (!other.is_empty())
        .then(|| format!("on a bound, not determined by the record: {}", all_in_words(model, other)));
    match (zero, other) {
        (Some(zero), Some(other)) => Some(format!("{zero}; {other}")),
        (zero, other) => zero.or(other),
    }
}

/// A damper of a chain below this share of `M/T`, of the mass and the window of a fit, stands for none: the least that
/// searches in logarithms reach is 1e-5 of it.
const NO_DAMPER: f64 = 1e-4;

/// Of the parameters on a bound those whose bound is not zero: the value is that of the search, so it is fixed in the
/// fit and has no interval. A damper of a chain of masses (the Kelvin model is one) on its lower bound is not fixed:
/// it goes to zero. `window_s`: end of the window, s after contact.
pub(crate) fn fixed_at_bound(model: &Model, active_bounds: &[&'static str], window_s: f64) -> Vec<&'static str> {
    let (values, kind) = (model.parameters(), model.kind());
    let is_chain =
        matches!(model, Model::Kelvin(_) | Model::DoubleSpringMassDamper(_) | Model::TripleSpringMassDamper(_));
    let least = if is_chain { NO_DAMPER * mass_of(model) / window_s } else { 0.0 };
    let is_damper = |name: &str| kind.parameter(name).is_some_and(|p| p.kind == ParameterKind::Damping);
    let nothing = |name: &str| if is_damper(name) { least } else { 0.0 };
    active_bounds.iter().copied().filter(|name| values.get(*name).is_some_and(|value| *value > nothing(name))).collect()
}

#[cfg(test)]
mod tests {
    use crumple_lumped::{Kelvin, Maxwell};

    use super::*;

    #[test]
    fn zero_is_an_answer_and_another_bound_is_not() {
        let model = Model::Kelvin(Kelvin { mass_kg: 1.0, stiffness_n_per_m: 2.0, damping_n_s_per_m: 0.0 });
        let said = |names: &[&'static str]| bounds_remark(&model, names);
        assert_eq!(said(&[]), None);
        assert_eq!(said(&["damping_n_s_per_m"]).as_deref(), Some("zero, the smallest value possible: damping"));
        let both = said(&["stiffness_n_per_m", "damping_n_s_per_m"]);
        let text = "zero, the smallest value possible: damping; on a bound, not determined by the record: stiffness";
        assert_eq!(both.as_deref(), Some(text));
    }

    #[test]
    fn a_damper_at_nothing_is_free_to_be_zero_and_a_large_one_is_held() {
        // 1e-4 of 1000 kg over 0.1 s is 1 N s/m.
        let kelvin = |c: f64| Model::Kelvin(Kelvin { mass_kg: 1e3, stiffness_n_per_m: 1e5, damping_n_s_per_m: c });
        let both = ["stiffness_n_per_m", "damping_n_s_per_m"];
        assert_eq!(fixed_at_bound(&kelvin(0.1), &both, 0.1), both[..1]);
        assert_eq!(fixed_at_bound(&kelvin(10.0), &both, 0.1), both);
        // In series a damper of nothing is no model.
        let maxwell = Maxwell { mass_kg: 1e3, stiffness_n_per_m: 1e5, damping_n_s_per_m: 0.1 };
        assert_eq!(fixed_at_bound(&Model::Maxwell(maxwell), &both, 0.1), both);
    }
}

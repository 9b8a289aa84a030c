//! A candidate in the choice: what its fit and its model say of it.

use std::collections::BTreeMap;

use crumple_lumped::{ModelKind, ParameterKind, parameter_kind};

/// What takes the energy of the impact in a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum EnergyClass {
    /// Plastic deformation.
    Plastic,
    /// Dampers.
    Damped,
    /// Nothing: springs give all of it back.
    Elastic,
}

impl EnergyClass {
    /// The class of a candidate, from the names of model and parameters in its record.
    pub fn of(model: &str, parameters: &BTreeMap<String, f64>) -> Self {
        let plastic = match model.parse::<ModelKind>() {
            Ok(ModelKind::Elastoplastic | ModelKind::ForceDeflection | ModelKind::LoadPaths) => true,
            Ok(
                ModelKind::Kelvin
                | ModelKind::Maxwell
                | ModelKind::Nonlinear1
                | ModelKind::Nonlinear2
                | ModelKind::DoubleSpringMassDamper
                | ModelKind::TripleSpringMassDamper,
            )
            | Err(_) => false,
        };
        if plastic {
            Self::Plastic
        } else if depends_on_rate(model, parameters) {
            Self::Damped
        } else {
            Self::Elastic
        }
    }

    /// Its name in records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plastic => "plastic",
            Self::Damped => "damped",
            Self::Elastic => "elastic",
        }
    }
}

/// Whether a force of the model depends on a rate.
pub fn depends_on_rate(model: &str, parameters: &BTreeMap<String, f64>) -> bool {
    parameters.iter().any(|(name, value)| match parameter_kind(model, name) {
        Some(ParameterKind::Damping) => *value != 0.0,
        // A rate is the place of a damper's knot; a rate factor of a structure is a prior and small.
        Some(
            ParameterKind::Mass
            | ParameterKind::Stiffness
            | ParameterKind::Length
            | ParameterKind::Rate
            | ParameterKind::Force
            | ParameterKind::RateFactor,
        )
        | None => false,
    })
}

/// How a model misses the events of its own test.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OwnTestErrors {
    /// Dynamic crush of the model over that of the test, less 1; `None`: the model does not stop.
    pub crush: Option<f64>,
    /// Time of dynamic crush of the model over that of the test, less 1; `None`: the model does not stop.
    pub time: Option<f64>,
    /// Restitution of the model, 0 without a rebound, less that of the test; `None`: the test shows none, or the model
    /// does not stop.
    pub restitution: Option<f64>,
}

impl OwnTestErrors {
    /// The largest error of each in several tests; `None` where one of the tests has none of crush or time.
    pub fn worst(each: &[Self]) -> Self {
        let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        let of_all = |of: fn(&Self) -> Option<f64>| -> Option<f64> {
            each.iter().map(of).collect::<Option<Vec<f64>>>()?.into_iter().reduce(larger)
        };
        Self {
            crush: of_all(|errors| errors.crush),
            time: of_all(|errors| errors.time),
            restitution: each.iter().filter_map(|errors| errors.restitution).reduce(larger),
        }
    }
}

/// One candidate in the choice.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedCandidate {
    /// Its id.
    pub id: String,
    /// Name of its model.
    pub model: String,
    /// What takes the energy.
    pub class: EnergyClass,
    /// How many masses it has.
    pub masses: usize,
    /// Free numbers.
    pub parameters: usize,
    /// Whether anybody says how well they are known.
    pub is_assessed: bool,
    /// Of these, what the record does not determine, in words.
    pub open: Vec<String>,
    /// How many of the others it knows to an order of magnitude only.
    pub order_of_magnitude: usize,
    /// Of these, what would change the crush at other speeds if it were another, in words.
    pub open_and_felt: Vec<String>,
    /// Parameters on a bound of their search other than zero, in words.
    pub on_bound: Vec<String>,
    /// Whether no spring or damper is negative.
    pub physical: bool,
    /// Model less record as measured, the quantity of the evidence at every sample of the window; `None`: the model has
    /// no response.
    pub misfit: Option<Vec<f64>>,
    /// The part of it that is slower than 60 Hz: what is evidence where the noise is known, and no ringing of a sensor.
    pub slow_misfit: Option<Vec<f64>>,
    /// Displacement fit as measured, percent.
    pub fit_percent: Option<f64>,
    /// Of sensors on other masses the one that it follows worst: channel and displacement fit, percent.
    pub worst_sensor: Option<(String, f64)>,
    /// Coefficient of restitution of the model in the test; `None`: it does not come back.
    pub restitution: Option<f64>,
    /// Misfit of the wall's force, percent of its root mean square; `None`: the record has no such force.
    pub force_misfit_percent: Option<f64>,
    /// How it misses the events of the test, the largest error of each in several.
    pub own_test: OwnTestErrors,
    /// Of a plastic model, the largest relative error of the crush at lower speeds that the record itself shows.
    pub crush_error_at_lower_speeds: Option<f64>,
}

impl ComparedCandidate {
    /// How many of its numbers the record determines.
    pub fn determined(&self) -> usize {
        if self.is_assessed { self.parameters.saturating_sub(self.open.len() + self.order_of_magnitude) } else { 0 }
    }

    /// `3 of 4 numbers determined, 1 with a wide interval`, as the report says it.
    pub fn determined_in_words(&self) -> String {
        if !self.is_assessed {
            return format!("{} numbers, not known how well", self.parameters);
        }
        let mut text = format!("{} of {} numbers determined", self.determined(), self.parameters);
        for (count, what) in [(self.order_of_magnitude, "with a wide interval"), (self.open.len(), "open")] {
            if count > 0 {
                text.push_str(&format!(", {count} {what}"));
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_is_that_of_the_model_and_of_its_dampers() {
        let kelvin = |c: f64| [("mass_kg", 1.0), ("stiffness_n_per_m", 2.0), ("damping_n_s_per_m", c)];
        let class = |model: &str, parameters: &[(&str, f64)]| {
            EnergyClass::of(model, &parameters.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect())
        };
        assert_eq!(class("kelvin", &kelvin(3.0)), EnergyClass::Damped);
        assert_eq!(class("kelvin", &kelvin(0.0)), EnergyClass::Elastic);
        assert_eq!(class("elastoplastic", &[]), EnergyClass::Plastic);
        assert_eq!(class("chain", &[("c1_n_s_per_m", 5.0)]), EnergyClass::Damped);
        assert_eq!(class("nonlinear-2", &[("v1_m_per_s", 5.0)]), EnergyClass::Elastic);
    }
}

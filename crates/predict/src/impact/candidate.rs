//! A candidate: a model with the parameters of a test, and how well these are known.

use std::collections::BTreeMap;

use crumple_lumped::{ParameterKind, Structure, parameter_kind, structure_of};
use crumple_lumped_fit::{EnergyClass, depends_on_rate};

use crate::error::PredictError;

/// How well the parameters of a candidate are known, as measured.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ParameterSpread {
    /// Standard deviations by name, in the unit of each.
    pub standard_deviation: BTreeMap<String, f64>,
    /// Parameters in the order of the correlations.
    pub order: Vec<String>,
    /// Their correlations, rows as `order`.
    pub correlation: Vec<Vec<f64>>,
    /// Parameters that the record does not determine.
    pub open: Vec<String>,
}

/// A model with the parameters of a test.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Its id.
    pub id: String,
    /// Its model, as candidates name it.
    pub model: String,
    /// Its parameters by name.
    pub parameters: BTreeMap<String, f64>,
    /// How well they are known; `None`: nobody says.
    pub spread: Option<ParameterSpread>,
    /// Criterion with priors above the lowest; `None`: it is not among the adequate.
    pub difference: Option<f64>,
}

impl Candidate {
    /// What takes the energy in it.
    pub fn class(&self) -> EnergyClass {
        EnergyClass::of(&self.model, &self.parameters)
    }

    /// Whether a force of it depends on a rate.
    pub fn depends_on_rate(&self) -> bool {
        depends_on_rate(&self.model, &self.parameters)
    }

    /// Whether it has a rate factor of a structure, which is a prior.
    pub fn has_rate_factor(&self) -> bool {
        let is_one = |name: &String| parameter_kind(&self.model, name) == Some(ParameterKind::RateFactor);
        self.parameters.iter().any(|(name, value)| is_one(name) && *value != 0.0)
    }

    /// Whether its rate factor was fitted to tests at several speeds: then its deviation is known.
    pub fn rate_factor_is_fitted(&self) -> bool {
        let Some(spread) = &self.spread else { return false };
        spread.order.iter().any(|name| parameter_kind(&self.model, name) == Some(ParameterKind::RateFactor))
    }

    /// Its structure, with a total mass where one is asked for: what is added or taken away is the compartment's.
    /// Errors: parameters without meaning, a mass that leaves the compartment none.
    pub fn structure(&self, mass_kg: Option<f64>) -> Result<Structure, PredictError> {
        with_mass(structure_of(&self.model, &self.parameters)?.with_trends_beyond(), mass_kg)
    }

    /// The same with some parameters multiplied by factors.
    pub(crate) fn changed(
        &self,
        factors: &BTreeMap<String, f64>,
        mass_kg: Option<f64>,
    ) -> Result<Structure, PredictError> {
        let mut parameters = self.parameters.clone();
        for (name, factor) in factors {
            if let Some(value) = parameters.get_mut(name) {
                *value *= factor;
            }
        }
        with_mass(structure_of(&self.model, &parameters)?.with_trends_beyond(), mass_kg)
    }

    /// How it goes on beyond what was tested, in words.
    pub fn rule_beyond_the_test(&self) -> &'static str {
        match self.model.as_str() {
            "elastoplastic" => "its loading stiffness",
            "nonlinear-1" | "nonlinear-2" => "the last values of stiffness and damping",
            "kelvin" | "maxwell" | "double-spring-mass-damper" | "triple-spring-mass-damper" => {
                "constant stiffness and damping"
            }
            "chain" => "the last values of its stiffnesses and dampings",
            _ => "the trend of its curve",
        }
    }
}

/// The structure with this total mass.
fn with_mass(structure: Structure, mass_kg: Option<f64>) -> Result<Structure, PredictError> {
    let Some(asked_kg) = mass_kg else { return Ok(structure) };
    let mut masses = structure.masses_kg().to_vec();
    let total: f64 = masses.iter().sum();
    let Some(compartment) = masses.last_mut() else { return Ok(structure) };
    let front_kg = total - *compartment;
    if asked_kg <= front_kg {
        return Err(PredictError::Mass { asked_kg, front_kg });
    }
    *compartment = asked_kg - front_kg;
    Ok(Structure::new(masses, structure.connections().to_vec())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn double() -> Candidate {
        let values = [
            ("m1_kg", 300.0),
            ("m2_kg", 900.0),
            ("k1_n_per_m", 4e5),
            ("k2_n_per_m", 3e5),
            ("c1_n_s_per_m", 2e3),
            ("c2_n_s_per_m", 1e3),
        ];
        Candidate {
            id: "double-spring-mass-damper/direct-fit/1".to_owned(),
            model: "double-spring-mass-damper".to_owned(),
            parameters: values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(),
            spread: None,
            difference: None,
        }
    }

    #[test]
    fn added_mass_is_the_compartments() {
        let masses = |mass_kg| double().structure(mass_kg).map(|structure| structure.masses_kg().to_vec());
        assert_eq!(masses(None), Ok(vec![300.0, 900.0]));
        assert_eq!(masses(Some(1500.0)), Ok(vec![300.0, 1200.0]));
        assert_eq!(masses(Some(300.0)), Err(PredictError::Mass { asked_kg: 300.0, front_kg: 300.0 }));
    }

    #[test]
    fn a_factor_changes_its_parameter_alone() {
        let factors = [("k1_n_per_m".to_owned(), 2.0)].into();
        let mut stiffer = double();
        stiffer.parameters.insert("k1_n_per_m".to_owned(), 8e5);
        assert_eq!(double().changed(&factors, None), stiffer.structure(None));
    }
}

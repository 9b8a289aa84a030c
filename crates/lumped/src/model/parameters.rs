//! Parameters by name, as candidates carry them.
//!
//! On disk and in fits a model is a map from names to numbers in SI, and every name ends with its unit. This is where
//! the maps become models and back; what each name stands for is in `kind/parameter.rs`.

use std::collections::BTreeMap;

use crate::{
    Chain, CrushedStructure, DoubleSpringMassDamper, Elastoplastic, Kelvin, LumpedError, Maxwell, Model, ModelKind,
    Nonlinear1, Nonlinear2, ParameterKind, Structure, TripleSpringMassDamper,
};

/// What a parameter of a candidate is, from the names of model and parameter in its record.
///
/// A family ([`ModelKind`]) has its table, everything else is asked as a chain ([`Chain::parameter_kind`]). A
/// model of another program may have parameters of its own: for these the unit counts that docs/format.md asks every
/// name to end with. `None` for a parameter that the family does not have, or that ends in none of these units.
pub fn parameter_kind(model: &str, name: &str) -> Option<ParameterKind> {
    if let Ok(family) = model.parse::<ModelKind>() {
        return family.parameter(name).map(|parameter| parameter.kind);
    }
    Chain::parameter_kind(name).or_else(|| parameter_kind_of_unit(name))
}

/// The structure of a candidate, from the names of model and parameters in its record: of a family ([`ModelKind`]), or
/// of a `chain`. Errors: a name that is neither, and what the parameters are refused for.
pub fn structure_of(model: &str, parameters: &BTreeMap<String, f64>) -> Result<Structure, LumpedError> {
    if model == "chain" {
        return Chain::from_parameters(parameters)?.structure();
    }
    Model::from_parameters(model.parse()?, parameters)?.structure()
}

/// What a number may be by the unit that its name ends with; `None` for a unit of no parameter.
pub fn parameter_kind_of_unit(name: &str) -> Option<ParameterKind> {
    // Stiffness and damping are asked before length: their units end like its own.
    ParameterKind::ALL.into_iter().find(|kind| kind.symbol_of(name) != name)
}

impl Model {
    /// Builds a model from named parameters: exactly those of [`ModelKind::parameter_names`], of the knots of a crushed
    /// structure the first ones; without a rate factor it has none.
    ///
    /// An elastoplastic model gets `release = true`: after rebound a vehicle leaves the barrier.
    pub fn from_parameters(kind: ModelKind, parameters: &BTreeMap<String, f64>) -> Result<Self, LumpedError> {
        let names = kind.parameter_names();
        if let Some(name) = parameters.keys().find(|name| !names.contains(&name.as_str())) {
            return Err(LumpedError::UnknownParameter { model: kind, name: name.clone(), expected: names.join(", ") });
        }
        let value = |name: &&'static str| {
            let optional = match kind.parameter(name).map(|parameter| parameter.kind) {
                Some(ParameterKind::RateFactor) => Some(0.0),
                Some(ParameterKind::Force | ParameterKind::Length) if kind == ModelKind::ForceDeflection => {
                    Some(f64::NAN)
                }
                _ => None,
            };
            parameters.get(*name).copied().or(optional).ok_or(LumpedError::MissingParameter { model: kind, name })
        };
        let values: Vec<f64> = names.iter().map(value).collect::<Result<_, _>>()?;
        let model = Self::of_values(kind, &values)?;
        model.check()?;
        Ok(model)
    }

    /// The model of a family with these values, in the order of [`ModelKind::parameters`]; whether they have a meaning
    /// is not checked. Errors: a curve with knots that do not rise.
    pub fn of_values(kind: ModelKind, values: &[f64]) -> Result<Self, LumpedError> {
        Ok(match kind {
            ModelKind::Kelvin => Self::Kelvin(Kelvin::from_values(values)),
            ModelKind::Elastoplastic => Self::Elastoplastic(Elastoplastic::from_values(values)),
            ModelKind::Maxwell => Self::Maxwell(Maxwell::from_values(values)),
            ModelKind::Nonlinear1 => Self::Nonlinear1(Nonlinear1::from_values(values)),
            ModelKind::Nonlinear2 => Self::Nonlinear2(Nonlinear2::from_values(values)),
            ModelKind::DoubleSpringMassDamper => {
                Self::DoubleSpringMassDamper(DoubleSpringMassDamper::from_values(values))
            }
            ModelKind::TripleSpringMassDamper => {
                Self::TripleSpringMassDamper(TripleSpringMassDamper::from_values(values))
            }
            ModelKind::ForceDeflection => Self::ForceDeflection(CrushedStructure::from_values(values)?),
        })
    }

    /// The same model with other values, in the order of [`values`](Self::values). Whether an elastoplastic model
    /// leaves the barrier is no parameter, and kept. Whether the values have a meaning is not checked: its
    /// [`structure`](Self::structure) does. Errors: a curve with knots that do not rise.
    pub fn with_values(&self, values: &[f64]) -> Result<Self, LumpedError> {
        let mut model = Self::of_values(self.kind(), values)?;
        if let (Self::Elastoplastic(new), Self::Elastoplastic(old)) = (&mut model, self) {
            new.release = old.release;
        }
        Ok(model)
    }

    /// The parameters by name.
    ///
    /// The same names and numbers that [`from_parameters`](Self::from_parameters) takes.
    pub fn parameters(&self) -> BTreeMap<String, f64> {
        let named = self.kind().parameter_names().iter().map(|name| (*name).to_owned()).zip(self.values());
        named.filter(|(_, value)| !value.is_nan()).collect()
    }

    /// Whether the parameters describe a passive structure: springs positive, dampers positive or zero. The
    /// coefficients of a nonlinear model may be zero at a knot.
    pub fn is_physical(&self) -> bool {
        let nonlinear = matches!(self, Self::Nonlinear1(_) | Self::Nonlinear2(_));
        let may_vanish = |kind| match kind {
            ParameterKind::Damping | ParameterKind::Force | ParameterKind::RateFactor => true,
            ParameterKind::Stiffness => nonlinear,
            ParameterKind::Mass | ParameterKind::Length | ParameterKind::Rate => false,
        };
        let parameters = self.kind().parameters().iter().zip(self.values());
        let mut given = parameters.filter(|(_, value)| !value.is_nan());
        given.all(|(parameter, value)| value > 0.0 || (value == 0.0 && may_vanish(parameter.kind)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_reads_its_own_parameters_back() {
        for kind in ModelKind::ALL {
            let names = kind.parameter_names();
            let values: BTreeMap<String, f64> =
                names.iter().enumerate().map(|(i, name)| ((*name).to_owned(), 1.5 + i as f64)).collect();
            let model = Model::from_parameters(kind, &values).unwrap();
            assert_eq!(model.kind(), kind);
            assert_eq!(model.parameters(), values);
            assert!(model.is_physical());
        }
    }

    #[test]
    fn a_kind_is_that_of_the_family_or_of_a_chain_or_of_the_unit() {
        assert_eq!(parameter_kind("nonlinear-2", "x1_m"), Some(ParameterKind::Length));
        assert_eq!(parameter_kind("nonlinear-2", "v1_m_per_s"), Some(ParameterKind::Rate));
        assert_eq!(parameter_kind("kelvin", "k1_n_per_m"), None);
        assert_eq!(parameter_kind("chain", "c2_knot1_n_s_per_m"), Some(ParameterKind::Damping));
        assert_eq!(parameter_kind("sled", "payload_kg"), Some(ParameterKind::Mass));
        assert_eq!(parameter_kind("sled", "gap_m"), Some(ParameterKind::Length));
        assert_eq!(parameter_kind("sled", "friction_1"), None);
    }

    #[test]
    fn a_structure_is_that_of_the_family_or_of_the_chain() {
        let model = Model::Kelvin(Kelvin { mass_kg: 900.0, stiffness_n_per_m: 3e5, damping_n_s_per_m: 2e3 });
        assert_eq!(structure_of("kelvin", &model.parameters()), model.structure());
        let chain = Chain::with_constants(&[200.0, 700.0], &[3e5, 4e5], &[1e3, 2e3]).unwrap();
        assert_eq!(structure_of("chain", &chain.parameters()), chain.structure());
        assert!(matches!(structure_of("sled", &chain.parameters()), Err(LumpedError::UnknownModel { .. })));
    }

    #[test]
    fn names_what_is_missing_unknown_or_meaningless() {
        let mut p = BTreeMap::from([("mass_kg".to_owned(), 900.0), ("stiffness_n_per_m".to_owned(), 3e5)]);
        let error = |p: &BTreeMap<String, f64>| Model::from_parameters(ModelKind::Kelvin, p).unwrap_err().to_string();
        assert_eq!(error(&p), "model kelvin needs the parameter damping_n_s_per_m");
        p.insert("damping_n_s_per_m".to_owned(), f64::NAN);
        assert_eq!(error(&p), "damping_n_s_per_m is NaN, expected a finite number");
        p.insert("damping_n_s_per_m".to_owned(), 0.0);
        p.insert("mass_kg".to_owned(), -1.0);
        assert_eq!(error(&p), "mass_kg is -1, expected a positive number");
        p.insert("mass".to_owned(), 1.0);
        assert!(error(&p).starts_with("model kelvin has no parameter \"mass\""));
    }
}

//! A model of which some parameters are free, near the values that it has.

use std::collections::BTreeMap;

use crumple_lumped::{Instants, LumpedError, Model, ModelKind, ParameterKind, Sensitivity};

use crate::free::free_numbers::FreeNumbers;
use crate::free::free_parameter::{FreeParameter, masses_of, rest_mass};
use crate::free::parameterisation::{Axis, Parameterisation};
use crate::record::observation::Impact;

/// A model of which some parameters are free; the coordinates are those of [`FreeParameter`].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FreeModel {
    /// The model with the values of everything that is not free.
    pub template: Model,
    /// What is free, in the order of the coordinates.
    pub free: Vec<FreeParameter>,
}

impl FreeModel {
    /// The coordinates of the template.
    pub fn start(&self) -> Vec<f64> {
        self.free.iter().map(|p| p.coordinate(p.value)).collect()
    }
}

/// The same model with other values by name; `None` for values without meaning. Whether an elastoplastic model leaves
/// the barrier is no parameter, and kept.
pub(crate) fn with_parameters(template: &Model, values: &BTreeMap<String, f64>) -> Option<Model> {
    let kind: ModelKind = template.kind();
    let mut model = Model::from_parameters(kind, values).ok()?;
    if let (Model::Elastoplastic(new), Model::Elastoplastic(old)) = (&mut model, template) {
        new.release = old.release;
    }
    Some(model)
}

/// The same model with another total mass, kg: what is more or less is the last mass's. `None` where nothing is left
/// for it.
pub(crate) fn with_total_mass(model: &Model, mass_kg: f64) -> Option<Model> {
    let masses = masses_of(model);
    let (last, others) = masses.split_last()?;
    let mut values = model.parameters();
    *values.get_mut(last.0)? = mass_kg - others.iter().map(|(_, kg)| kg).sum::<f64>();
    with_parameters(model, &values)
}

impl Parameterisation for FreeModel {
    type Model = Model;

    /// Bounds of each coordinate; nothing is searched for.
    fn axes(&self) -> Vec<Axis> {
        let axis = |p: &FreeParameter| {
            let (lower, upper) = p.bounds();
            Axis { lower, upper, box_lower: lower, box_upper: upper }
        };
        self.free.iter().map(axis).collect()
    }

    /// The model at a point; `None` where its parameters are not physical. With free masses the last mass is the rest
    /// of the total of the template.
    fn model(&self, theta: &[f64]) -> Option<Model> {
        let mut values = self.template.parameters();
        for (parameter, coordinate) in self.free.iter().zip(theta) {
            *values.get_mut(parameter.name)? = parameter.at(*coordinate);
        }
        if let Some((rest, _)) = rest_mass(&self.template, &self.free) {
            // The total is known.
            let masses = masses_of(&self.template);
            let total: f64 = masses.iter().map(|(_, kg)| kg).sum();
            let others: f64 = masses.iter().filter(|(name, _)| *name != rest).map(|(name, _)| values[*name]).sum();
            *values.get_mut(rest)? = total - others;
        }
        with_parameters(&self.template, &values)
    }

    /// That of the model itself.
    fn sensitivity(
        &self,
        model: &Model,
        impact_speed_m_per_s: f64,
        at: &Instants,
        places: &[usize],
    ) -> Result<Sensitivity, LumpedError> {
        model.sensitivity(impact_speed_m_per_s, at, places)
    }

    /// That of the model with the mass of the impact.
    fn sensitivity_in(
        &self,
        model: &Model,
        impact: Impact,
        at: &Instants,
        places: &[usize],
    ) -> Result<Sensitivity, LumpedError> {
        let Some(mass_kg) = impact.mass_kg else {
            return self.sensitivity(model, impact.speed_m_per_s, at, places);
        };
        let expected = "more than the masses in front of the compartment";
        let loaded = with_total_mass(model, mass_kg);
        loaded.ok_or(LumpedError::Value { name: "mass_kg", value: mass_kg, expected })?.sensitivity(
            impact.speed_m_per_s,
            at,
            places,
        )
    }

    /// Each coordinate moves its own parameter; a mass that is free is taken from the last one.
    fn derivatives_by_coordinate(&self, theta: &[f64]) -> Vec<Vec<(usize, f64)>> {
        let names = self.template.kind().parameter_names();
        let place = |name: &str| names.iter().position(|other| *other == name);
        let rest = rest_mass(&self.template, &self.free).and_then(|(name, _)| place(name));
        let changes = |(parameter, x): (&FreeParameter, &f64)| {
            let slope = parameter.slope(*x);
            let taken = rest.filter(|_| parameter.kind == ParameterKind::Mass).map(|rest| (rest, -slope));
            place(parameter.name).map(|own| (own, slope)).into_iter().chain(taken).collect()
        };
        self.free.iter().zip(theta).map(changes).collect()
    }
}

impl FreeNumbers for FreeModel {
    fn names(&self) -> Vec<String> {
        self.free.iter().map(|p| p.name.to_owned()).collect()
    }

    fn kind(&self, index: usize) -> ParameterKind {
        self.free[index].kind
    }

    fn is_logarithmic(&self, index: usize) -> bool {
        self.free[index].logarithmic
    }

    fn value(&self, index: usize, coordinate: f64) -> f64 {
        self.free[index].at(coordinate)
    }

    fn coordinate(&self, index: usize, value: f64) -> f64 {
        self.free[index].coordinate(value)
    }

    fn slope(&self, index: usize, coordinate: f64) -> f64 {
        self.free[index].slope(coordinate)
    }

    fn rest(&self, theta: &[f64]) -> Option<(String, f64)> {
        rest_mass(&self.model(theta)?, &self.free).map(|(name, kg)| (name.to_owned(), kg))
    }
}

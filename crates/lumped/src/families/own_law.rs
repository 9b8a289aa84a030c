//! A law of one's own: masses, elements whose forces are expressions, parameters with units and bounds.
//!
//! It is one more structure of masses and elements. Everything that any structure answers (motions, derivatives,
//! events, energies) is answered for it by the same code.

use std::sync::Arc;

use crate::error::finite;
use crate::families::law_text::{self, LawMistake};
use crate::series::expression_series::has_series_at;
use crate::structure::connected_masses::{Connection, Node, Place, Structure};
use crate::structure::own_force::{ForceLaw, OwnForce};
use crate::{LumpedError, ParameterKind};

/// A number between bounds, from a start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeNumber {
    /// Smallest value, above zero.
    pub lower: f64,
    /// Largest value.
    pub upper: f64,
    /// Where a search starts first.
    pub start: Option<f64>,
}

impl FreeNumber {
    /// The start, else the geometric mean of the bounds.
    pub fn first(&self) -> f64 {
        self.start.unwrap_or_else(|| (self.lower * self.upper).sqrt())
    }
}

/// What a mass is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LawMass {
    /// What the others leave of the vehicle.
    Rest,
    /// A share of the vehicle.
    Share(f64),
    /// This mass, kg.
    Given(f64),
    /// To be fitted, kg.
    Free(FreeNumber),
}

/// A parameter of a law: given, or to be fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum LawNumber {
    Given(f64),
    Free(FreeNumber),
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LawParameter {
    /// As it stands in expressions.
    pub symbol: String,
    /// As it stands in candidates, with its unit.
    pub name: String,
    pub kind: ParameterKind,
    pub number: LawNumber,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LawElement {
    pub front: Node,
    pub rear: Node,
    pub law: Arc<ForceLaw>,
}

/// Masses and elements with forces of one's own, without values. SI throughout.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnLaw {
    pub(crate) name: Option<String>,
    pub(crate) text: String,
    /// Names and masses, the measured one last.
    pub(crate) masses: Vec<(String, LawMass)>,
    pub(crate) elements: Vec<LawElement>,
    pub(crate) parameters: Vec<LawParameter>,
}

impl OwnLaw {
    /// Reads the text of a law, a TOML file. Errors: what is wrong with it, with line and column.
    pub fn read(text: &str) -> Result<Self, LawMistake> {
        law_text::read(text)
    }

    /// Its own name, if it states one.
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// The text it was read from.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Names of the masses, the measured one last.
    pub fn mass_names(&self) -> Vec<String> {
        self.masses.iter().map(|(name, _)| name.clone()).collect()
    }

    /// What the masses are, in the same order.
    pub fn masses(&self) -> impl Iterator<Item = LawMass> {
        self.masses.iter().map(|(_, mass)| *mass)
    }

    /// Of each parameter its name in candidates, what it is, and what a fit may do with it; `None` where it is given.
    pub fn parameters(&self) -> impl Iterator<Item = (&str, ParameterKind, Option<FreeNumber>)> {
        self.parameters.iter().map(|parameter| {
            let free = if let LawNumber::Free(free) = parameter.number { Some(free) } else { None };
            (parameter.name.as_str(), parameter.kind, free)
        })
    }

    /// Whether an element keeps its largest deflection.
    pub fn is_plastic(&self) -> bool {
        self.elements.iter().any(|element| element.law.unloading != crate::structure::own_force::Unloading::Elastic)
    }

    /// Whether a force depends on the rate.
    pub fn depends_on_rate(&self) -> bool {
        self.elements.iter().any(|element| element.law.force.has_rate())
    }
}

/// A law of one's own with values: masses, then parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnModel {
    law: Arc<OwnLaw>,
    values: Vec<f64>,
}

impl OwnModel {
    /// The law in a vehicle of this mass, kg, each number at its start. Errors: a mass that the vehicle does not leave.
    pub fn at_start(law: Arc<OwnLaw>, total_kg: f64) -> Result<Self, LumpedError> {
        let stated = law.masses().map(|mass| match mass {
            LawMass::Rest => 0.0,
            LawMass::Share(share) => share * total_kg,
            LawMass::Given(kg) => kg,
            LawMass::Free(free) => free.first(),
        });
        let mut values: Vec<f64> = stated.collect();
        let left = total_kg - values.iter().sum::<f64>();
        values.iter_mut().zip(law.masses()).filter(|(_, mass)| *mass == LawMass::Rest).for_each(|(kg, _)| *kg = left);
        values.extend(law.parameters.iter().map(|parameter| match parameter.number {
            LawNumber::Given(value) => value,
            LawNumber::Free(free) => free.first(),
        }));
        let model = Self { law, values };
        model.structure()?;
        Ok(model)
    }

    /// The law with these values by name. Errors: a name that is missing or too many, a mass that is none.
    pub fn from_parameters(
        law: Arc<OwnLaw>,
        parameters: &std::collections::BTreeMap<String, f64>,
    ) -> Result<Self, LumpedError> {
        let model = Self { values: vec![0.0; law.masses.len() + law.parameters.len()], law };
        let names = model.names();
        let problem = |name: &str, problem| LumpedError::ChainParameter { problem, name: name.to_owned() };
        if let Some(name) = parameters.keys().find(|name| !names.contains(name)) {
            return Err(problem(name, "has no parameter"));
        }
        let value = |name: &String| parameters.get(name).copied().ok_or_else(|| problem(name, "needs the parameter"));
        let model = model.with_values(&names.iter().map(value).collect::<Result<Vec<_>, _>>()?);
        model.structure()?;
        Ok(model)
    }

    /// The law.
    pub fn law(&self) -> &OwnLaw {
        &self.law
    }

    /// Masses, kg, from the barrier on, the measured one last; then the parameters in SI.
    pub fn values(&self) -> Vec<f64> {
        self.values.clone()
    }

    /// The same law with other values.
    #[must_use]
    pub fn with_values(&self, values: &[f64]) -> Self {
        Self { law: self.law.clone(), values: values.to_vec() }
    }

    /// Names of its [`values`](Self::values).
    pub fn names(&self) -> Vec<String> {
        let masses = (1..=self.law.masses.len()).map(|number| format!("m{number}_kg"));
        masses.chain(self.law.parameters.iter().map(|parameter| parameter.name.clone())).collect()
    }

    /// What the parameter of this name is.
    pub fn parameter_kind(&self, name: &str) -> Option<ParameterKind> {
        let place = self.names().iter().position(|own| own == name)?;
        let parameter = place.checked_sub(self.law.masses.len()).map(|place| self.law.parameters[place].kind);
        Some(parameter.unwrap_or(ParameterKind::Mass))
    }

    /// Masses, kg.
    pub fn masses_kg(&self) -> &[f64] {
        &self.values[..self.law.masses.len()]
    }

    /// Where its [`values`](Self::values) stand.
    pub fn places(&self) -> Vec<Place> {
        let masses = self.law.masses.len();
        (0..masses).map(Place::Mass).chain((0..self.law.parameters.len()).map(Place::Law)).collect()
    }

    /// The structure it is. Errors: a mass that is not positive, a value that is not finite.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        self.values.iter().try_for_each(|value| finite("parameter of an own model", *value))?;
        let (masses, parameters) = self.values.split_at(self.law.masses.len());
        let parameters: Arc<[f64]> = parameters.into();
        let join = |element: &LawElement| Connection {
            front: element.front,
            rear: element.rear,
            element: OwnForce::new(element.law.clone(), parameters.clone()).into(),
        };
        Structure::new(masses.to_vec(), self.law.elements.iter().map(join).collect())
    }

    /// Why no motion follows from these values: the first force that is no number at contact, at this speed in m/s.
    pub fn fault_at(&self, impact_speed_m_per_s: f64) -> Option<String> {
        let structure = self.structure().ok()?;
        let at = |(k, connection): (usize, &Connection)| {
            let own = connection.element.law().as_own()?;
            let force = own.force_n(0.0, impact_speed_m_per_s);
            let problem = if force.is_finite() { "has no Taylor series" } else { "is no number" };
            let fails = !force.is_finite() || !has_series_at(own, impact_speed_m_per_s);
            fails.then(|| {
                let number = k + 1;
                format!("the force of element {number} {problem} at x = 0 and v = {impact_speed_m_per_s:.2} m/s")
            })
        };
        structure.connections().iter().enumerate().find_map(at)
    }
}

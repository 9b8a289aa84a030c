//! A model of any family: its parameters by name, and what its structure answers.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use crate::families::chain::places_of_constants;
use crate::families::load_paths::CrushedLoadPaths;
use crate::kind::MOST_KNOTS;
use crate::motion::mass_motion::HORIZON_S;
use crate::structure::connected_masses::Place;
use crate::{
    Chain, CrushEvents, CrushedStructure, DoubleSpringMassDamper, Drive, Dynamics, Elastoplastic, Instants, Kelvin,
    LumpedError, Maxwell, ModelKind, Nonlinear1, Nonlinear2, OwnLaw, OwnModel, ParameterKind, Response, Sensitivity,
    Structure, TripleSpringMassDamper,
};

// [`Model`] is the one type that candidates, fits and simulations hold: whatever the family, it checks its parameters,
// knows its masses and the [`Structure`] it is a name for. What a family is made of is in `families/`.

/// A lumped model with its parameters.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "copied once a fit, not once a sample")]
pub enum Model {
    /// Spring and damper in parallel.
    Kelvin(Kelvin),
    /// Stiff unloading.
    Elastoplastic(Elastoplastic),
    /// Spring and damper in series.
    Maxwell(Maxwell),
    /// Stiffening spring, weakening damper.
    Nonlinear1(Nonlinear1),
    /// The same with one knot more each.
    Nonlinear2(Nonlinear2),
    /// Chassis and compartment.
    DoubleSpringMassDamper(DoubleSpringMassDamper),
    /// Engine, suspension and chassis, compartment.
    TripleSpringMassDamper(TripleSpringMassDamper),
    /// A structure that is crushed.
    ForceDeflection(CrushedStructure),
    /// Engine and compartment behind load paths that are crushed.
    LoadPaths(CrushedLoadPaths),
    /// Any number of masses in a row.
    Chain(Chain),
    /// Masses and elements with forces that a person states.
    Own(OwnModel),
}

/// The same of whatever family a model is.
macro_rules! of_family {
    ($model:expr, $family:ident => $what:expr) => {
        match $model {
            Model::Kelvin($family) => $what,
            Model::Elastoplastic($family) => $what,
            Model::Maxwell($family) => $what,
            Model::Nonlinear1($family) => $what,
            Model::Nonlinear2($family) => $what,
            Model::DoubleSpringMassDamper($family) => $what,
            Model::TripleSpringMassDamper($family) => $what,
            Model::ForceDeflection($family) => $what,
            Model::LoadPaths($family) => $what,
            Model::Chain($family) => $what,
            Model::Own($family) => $what,
        }
    };
}

impl Model {
    /// Which family it is of.
    pub fn kind(&self) -> ModelKind {
        match self {
            Self::Kelvin(_) => ModelKind::Kelvin,
            Self::Elastoplastic(_) => ModelKind::Elastoplastic,
            Self::Maxwell(_) => ModelKind::Maxwell,
            Self::Nonlinear1(_) => ModelKind::Nonlinear1,
            Self::Nonlinear2(_) => ModelKind::Nonlinear2,
            Self::DoubleSpringMassDamper(_) => ModelKind::DoubleSpringMassDamper,
            Self::TripleSpringMassDamper(_) => ModelKind::TripleSpringMassDamper,
            Self::ForceDeflection(_) => ModelKind::ForceDeflection,
            Self::LoadPaths(_) => ModelKind::LoadPaths,
            Self::Chain(_) => ModelKind::Chain,
            Self::Own(_) => ModelKind::Own,
        }
    }

    /// Refuses parameters for which the model has no meaning: masses that are not positive, numbers that are not
    /// finite. Negative springs and dampers pass where the equations allow them: solvers do return such sets.
    pub fn check(&self) -> Result<(), LumpedError> {
        self.structure().map(drop)
    }

    /// The structure it is a name for: masses and elements. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        of_family!(self, model => model.structure())
    }

    /// The values of its parameters, in the order of [`names`](Self::names); not a number for a knot it does not have.
    ///
    /// Whether the elastoplastic model lets go is no parameter: it is a choice of whoever simulates it.
    pub fn values(&self) -> Vec<f64> {
        of_family!(self, model => model.values())
    }

    /// Names of its [`values`](Self::values), masses first: those of its family; of a chain its masses, then the values
    /// of its springs and dampers, whose knots stay where they are.
    pub fn names(&self) -> Vec<Cow<'static, str>> {
        match self {
            Self::Chain(chain) => chain.names().into_iter().map(Cow::Owned).collect(),
            Self::Own(own) => own.names().into_iter().map(Cow::Owned).collect(),
            _ => self.kind().parameter_names().iter().map(|name| Cow::Borrowed(*name)).collect(),
        }
    }

    /// What the parameter of this name is; `None` if the model has none.
    pub fn parameter_kind(&self, name: &str) -> Option<ParameterKind> {
        match self {
            Self::Chain(_) => Chain::parameter_kind(name),
            Self::Own(own) => own.parameter_kind(name),
            _ => self.kind().parameter(name).map(|parameter| parameter.kind),
        }
    }

    /// Masses from the barrier on, kg.
    pub fn masses_kg(&self) -> Vec<f64> {
        if let Self::Chain(chain) = self {
            return chain.masses_kg().to_vec();
        }
        if let Self::Own(own) = self {
            return own.masses_kg().to_vec();
        }
        let parameters = self.kind().parameters().iter().zip(self.values());
        parameters.filter(|(parameter, _)| parameter.kind == ParameterKind::Mass).map(|(_, mass)| mass).collect()
    }
}

// Parameters by name, as candidates carry them.
//
// On disk and in fits a model is a map from names to numbers in SI, and every name ends with its unit. This is where
// the maps become models and back; what each name stands for is in `kind/parameter.rs`.

/// What a parameter of a candidate is, from the names of model and parameter in its record.
///
/// A family ([`ModelKind`]) has its table, everything else is asked as a chain ([`Chain::parameter_kind`]). A
/// model of another program may have parameters of its own: for these the unit counts that docs/format.md asks every
/// name to end with. `None` for a parameter that the family does not have, or that ends in none of these units.
pub fn parameter_kind(model: &str, name: &str) -> Option<ParameterKind> {
    if let Ok(family) = model.parse::<ModelKind>()
        && !matches!(family, ModelKind::Chain | ModelKind::Own)
    {
        let of_name = ModelKind::ALL.into_iter().filter(|kind| kind.name() == family.name());
        return of_name.filter_map(|kind| kind.parameter(name)).map(|parameter| parameter.kind).next();
    }
    Chain::parameter_kind(name).or_else(|| parameter_kind_of_unit(name))
}

/// The structure of a candidate, from the names of model and parameters in its record, and the text of its law.
/// Errors: as [`Model::read`].
pub fn structure_of(
    model: &str,
    law: Option<&str>,
    parameters: &BTreeMap<String, f64>,
) -> Result<Structure, LumpedError> {
    Model::read(model, law, parameters)?.structure()
}

/// What a number may be by the unit that its name ends with; `None` for a unit of no parameter.
pub fn parameter_kind_of_unit(name: &str) -> Option<ParameterKind> {
    // Stiffness and damping are asked before length: their units end like its own.
    ParameterKind::ALL.into_iter().find(|kind| kind.symbol_of(name) != name)
}

impl Model {
    /// The model of a candidate, from the names of model and parameters in its record, and the text of its law where
    /// it is an own model. Errors: a name of no kind, a text that is no law, and what the parameters are refused for.
    pub fn read(model: &str, law: Option<&str>, parameters: &BTreeMap<String, f64>) -> Result<Self, LumpedError> {
        match model.parse()? {
            ModelKind::Own => {
                let law = Arc::new(OwnLaw::read(law.ok_or(LumpedError::NoLaw)?)?);
                OwnModel::from_parameters(law, parameters).map(Self::Own)
            }
            kind => Self::from_parameters(kind, parameters),
        }
    }

    /// The text of its law, of an own model.
    pub fn law(&self) -> Option<&str> {
        if let Self::Own(own) = self { Some(own.law().text()) } else { None }
    }

    /// Builds a model from named parameters: exactly those of [`ModelKind::parameter_names`], of the knots of a crushed
    /// structure the first ones; without a rate factor it has none. Of crushed structures `m1_kg` makes the one with
    /// two masses.
    ///
    /// An elastoplastic model gets `release = true`: after rebound a vehicle leaves the barrier.
    pub fn from_parameters(kind: ModelKind, parameters: &BTreeMap<String, f64>) -> Result<Self, LumpedError> {
        if kind == ModelKind::Chain {
            let chain = Chain::from_parameters(parameters)?;
            chain.structure()?;
            return Ok(Self::Chain(chain));
        }
        let two_masses = kind == ModelKind::ForceDeflection && parameters.contains_key("m1_kg");
        let kind = if two_masses { ModelKind::LoadPaths } else { kind };
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
                Some(ParameterKind::Force | ParameterKind::Length | ParameterKind::Stiffness)
                    if kind == ModelKind::LoadPaths =>
                {
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
    /// is not checked. Errors: a curve with knots that do not rise; a chain, whose values do not say where its knots
    /// are.
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
            ModelKind::LoadPaths => Self::LoadPaths(CrushedLoadPaths::from_values(values)?),
            ModelKind::Chain => {
                let name = "knots of springs and dampers".to_owned();
                return Err(LumpedError::ChainParameter { problem: "needs the", name });
            }
            ModelKind::Own => return Err(LumpedError::NoLaw),
        })
    }

    /// The same model with other values, in the order of [`values`](Self::values). Whether an elastoplastic model
    /// leaves the barrier is no parameter, and kept. Whether the values have a meaning is not checked: its
    /// [`structure`](Self::structure) does. Errors: a curve with knots that do not rise.
    pub fn with_values(&self, values: &[f64]) -> Result<Self, LumpedError> {
        if let Self::Chain(chain) = self {
            return chain.with_values(values).map(Self::Chain);
        }
        if let Self::Own(own) = self {
            return Ok(Self::Own(own.with_values(values)));
        }
        let mut model = Self::of_values(self.kind(), values)?;
        if let (Self::Elastoplastic(new), Self::Elastoplastic(old)) = (&mut model, self) {
            new.release = old.release;
        }
        Ok(model)
    }

    /// The same model with some values changed, by name. `None` where one is no parameter of it, and where the model
    /// has no meaning then.
    pub fn changed<'a>(&self, changes: impl IntoIterator<Item = (&'a str, f64)>) -> Option<Self> {
        let (names, mut values) = (self.names(), self.values());
        for (name, value) in changes {
            *values.get_mut(names.iter().position(|other| other == name)?)? = value;
        }
        self.with_values(&values).ok().filter(|model| model.check().is_ok())
    }

    /// The value of the parameter of this name; `None` where it has none.
    pub fn value(&self, name: &str) -> Option<f64> {
        let place = self.names().iter().position(|other| other == name)?;
        self.values().get(place).copied().filter(|value| !value.is_nan())
    }

    /// The model as a vehicle leaves the barrier after rebound; others than the elastoplastic one stay what they are.
    #[must_use]
    pub fn released(&self) -> Self {
        let mut model = self.clone();
        if let Self::Elastoplastic(model) = &mut model {
            model.release = true;
        }
        model
    }

    /// The parameters by name.
    ///
    /// The same names and numbers that [`from_parameters`](Self::from_parameters) takes.
    pub fn parameters(&self) -> BTreeMap<String, f64> {
        if let Self::Chain(chain) = self {
            return chain.parameters();
        }
        if let Self::Own(own) = self {
            return own.names().into_iter().zip(own.values()).collect();
        }
        let named = self.kind().parameter_names().iter().map(|name| (*name).to_owned()).zip(self.values());
        named.filter(|(_, value)| !value.is_nan()).collect()
    }

    /// Whether the parameters describe a passive structure: springs positive, dampers positive or zero. The
    /// coefficients of a nonlinear model may be zero at a knot.
    pub fn is_physical(&self) -> bool {
        if let Self::Chain(chain) = self {
            return chain.is_passive();
        }
        // Whether its forces are those of a passive structure, only the motion shows.
        if let Self::Own(own) = self {
            return own.masses_kg().iter().all(|kg| *kg > 0.0);
        }
        let nonlinear = matches!(self, Self::Nonlinear1(_) | Self::Nonlinear2(_));
        let may_vanish = |kind| match kind {
            ParameterKind::Damping | ParameterKind::Force | ParameterKind::RateFactor | ParameterKind::Other => true,
            ParameterKind::Stiffness => nonlinear,
            ParameterKind::Mass | ParameterKind::Length | ParameterKind::Rate => false,
        };
        let parameters = self.kind().parameters().iter().zip(self.values());
        let mut given = parameters.filter(|(_, value)| !value.is_nan());
        given.all(|(parameter, value)| value > 0.0 || (value == 0.0 && may_vanish(parameter.kind)))
    }
}

// What a model answers: its structure's motions, forces, energies, events and derivatives, in the model's own names.

impl Model {
    /// Where its parameters stand in its [`structure`](Self::structure), in the order of [`names`](Self::names); of a
    /// chain the places of its knots follow.
    pub fn places(&self) -> Vec<Place> {
        if let Self::Chain(chain) = self {
            return chain.places();
        }
        if let Self::Own(own) = self {
            return own.places();
        }
        let knots = |places: &[(usize, usize)]| -> Vec<Place> {
            let element = |(connection, parameter): &(usize, usize)| Place::Element {
                connection: *connection,
                parameter: *parameter,
            };
            std::iter::once(Place::Mass(0)).chain(places.iter().map(element)).collect()
        };
        match self.kind() {
            ModelKind::Kelvin => places_of_constants(1),
            ModelKind::DoubleSpringMassDamper => places_of_constants(2),
            ModelKind::TripleSpringMassDamper => places_of_constants(3),
            ModelKind::Maxwell | ModelKind::Elastoplastic => knots(&[(0, 0), (0, 1)]),
            // Spring 0 and damper 1: value of knot j at 2 j, its place at 2 j + 1.
            ModelKind::Nonlinear1 => knots(&[(0, 0), (0, 2), (1, 0), (1, 2), (1, 4), (1, 3), (0, 3), (1, 5)]),
            ModelKind::Nonlinear2 => {
                knots(&[(0, 0), (0, 2), (0, 4), (0, 3), (1, 0), (1, 2), (1, 4), (1, 6), (1, 3), (1, 5), (0, 5), (1, 7)])
            }
            ModelKind::ForceDeflection => {
                let given = self.values().iter().filter(|value| !value.is_nan()).count();
                // Force of knot j at 2 (j - 1), its place one further; unloading and rate factor after all of them.
                let after = given - 3;
                let knot = |which: usize| (0..MOST_KNOTS).map(move |j| (0, 2 * j + which));
                knots(&knot(0).chain([(0, after), (0, after + 1)]).chain(knot(1)).collect::<Vec<_>>())
            }
            ModelKind::LoadPaths => CrushedLoadPaths::places(&self.values()),
            ModelKind::Chain | ModelKind::Own => Vec::new(),
        }
    }

    /// The model's name in an error of its structure.
    fn named(&self) -> impl Fn(LumpedError) -> LumpedError {
        let model = self.kind();
        move |error| match error {
            LumpedError::ChainDiverges { time_s } if model != ModelKind::Chain => {
                LumpedError::Diverges { model, time_s }
            }
            other => other,
        }
    }

    /// Events of the compartment, from the exact solution.
    pub fn events(&self, impact_speed_m_per_s: f64) -> Result<CrushEvents, LumpedError> {
        let structure = self.structure()?;
        let horizon_s = if structure.is_linear() { f64::INFINITY } else { HORIZON_S };
        let events = structure.events(impact_speed_m_per_s, horizon_s).map_err(self.named())?;
        Ok(events.last().copied().unwrap_or_default())
    }

    /// The motion of every mass at `t = k·dt_s`, k = 0 .. `samples`, from contact at `impact_speed_m_per_s`.
    ///
    /// Exact: linear models by repeated multiplication with one matrix exponential, whose rounding grows to about
    /// `samples·1e-16` of the largest motion, all others by Taylor series from event to event. Errors: parameters
    /// without meaning, or a response that leaves the range of numbers.
    pub fn respond(&self, impact_speed_m_per_s: f64, dt_s: f64, samples: usize) -> Result<Response, LumpedError> {
        let at = Instants { first_s: 0.0, dt_s, samples };
        let motions = self.structure()?.motions_at(impact_speed_m_per_s, &at).map_err(self.named())?;
        Ok(Response { dt_s, masses_kg: self.masses_kg(), motions })
    }

    /// Motions, forces and energies at `k dt`, k = 0 .. `samples`.
    ///
    /// After an impact the motions are those of [`Model::respond`]. Errors: as there, and a drive that is not finite or
    /// acts on a mass that is not there.
    pub fn dynamics(&self, drive: &Drive, dt_s: f64, samples: usize) -> Result<Dynamics, LumpedError> {
        self.structure()?.dynamics(drive, dt_s, samples).map_err(self.named())
    }

    /// The motion of every mass at these instants, and its derivatives by the parameters at these places of
    /// [`ModelKind::parameter_names`].
    ///
    /// Analytic throughout, see [`Structure::sensitivity`](crate::Structure::sensitivity). Errors: parameters without
    /// meaning, a place that is none, a motion that leaves the range of numbers.
    pub fn sensitivity(
        &self,
        impact_speed_m_per_s: f64,
        at: &Instants,
        parameters: &[usize],
    ) -> Result<Sensitivity, LumpedError> {
        let places = self.places();
        if let Some(place) = parameters.iter().find(|p| **p >= places.len()) {
            let expected = "the place of a parameter of the model";
            return Err(LumpedError::Value { name: "parameter", value: *place as f64, expected });
        }
        let places: Vec<Place> = parameters.iter().map(|p| places[*p]).collect();
        self.structure()?.sensitivity(impact_speed_m_per_s, at, &places).map_err(self.named())
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
        assert_eq!(structure_of("kelvin", None, &model.parameters()), model.structure());
        let chain = Chain::with_constants(&[200.0, 700.0], &[3e5, 4e5], &[1e3, 2e3]).unwrap();
        assert_eq!(structure_of("chain", None, &chain.parameters()), chain.structure());
        assert!(matches!(structure_of("sled", None, &chain.parameters()), Err(LumpedError::UnknownModel { .. })));
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

//! A candidate: a model with the parameters of a test, and the impacts that it is to meet.

use std::collections::BTreeMap;

use crumple_lumped::{LumpedError, Model, Occupant, ParameterKind, Structure};
use crumple_lumped_fit::{EnergyClass, depends_on_rate};

use crate::error::PredictError;
use crate::impact::made_test::MadeTest;

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
    /// Its model; an error where its record names none.
    pub model: Result<Model, LumpedError>,
    /// How well its parameters are known; `None`: nobody says.
    pub spread: Option<ParameterSpread>,
    /// What it weighs in a prediction; zero: nothing.
    pub weight: f64,
}

impl Candidate {
    /// What takes the energy in it; nothing where there is no model.
    pub fn class(&self) -> EnergyClass {
        self.model.as_ref().map_or(EnergyClass::Elastic, EnergyClass::of)
    }

    /// Whether a force of it depends on a rate.
    pub fn depends_on_rate(&self) -> bool {
        self.model.as_ref().is_ok_and(depends_on_rate)
    }

    /// The value of a parameter; `None` where it has none of this name.
    pub(crate) fn value(&self, name: &str) -> Option<f64> {
        self.model.as_ref().ok()?.value(name)
    }

    fn is_rate_factor(&self, name: &str) -> bool {
        self.model.as_ref().is_ok_and(|model| model.parameter_kind(name) == Some(ParameterKind::RateFactor))
    }

    /// Whether it has a rate factor of a structure, which is a prior.
    pub fn has_rate_factor(&self) -> bool {
        let Ok(model) = &self.model else { return false };
        model.parameters().iter().any(|(name, value)| self.is_rate_factor(name) && *value != 0.0)
    }

    /// Whether its rate factor was fitted to tests at several speeds: then its deviation is known.
    pub fn rate_factor_is_fitted(&self) -> bool {
        self.spread.as_ref().is_some_and(|spread| spread.order.iter().any(|name| self.is_rate_factor(name)))
    }

    /// Its structure, with a total mass where one is asked for: what is added or taken away is the compartment's.
    /// Errors: no model, parameters without meaning, a mass that leaves the compartment none.
    pub fn structure(&self, mass_kg: Option<f64>) -> Result<Structure, PredictError> {
        with_mass(self.model.clone()?.structure()?.with_trends_beyond(), mass_kg)
    }

    /// The same with some parameters multiplied by factors; `None` where the model has no meaning then.
    pub(crate) fn changed(&self, factors: &BTreeMap<String, f64>, mass_kg: Option<f64>) -> Option<Structure> {
        let changed = factors.iter().filter_map(|(name, factor)| Some((name.as_str(), self.value(name)? * factor)));
        let model = self.model.as_ref().ok()?.changed(changed)?;
        with_mass(model.structure().ok()?.with_trends_beyond(), mass_kg).ok()
    }

    /// How it goes on beyond what was tested, in words.
    pub fn rule_beyond_the_test(&self) -> &'static str {
        match &self.model {
            Ok(Model::Elastoplastic(_)) => "its loading stiffness",
            Ok(Model::Nonlinear1(_) | Model::Nonlinear2(_)) => "the last values of stiffness and damping",
            Ok(
                Model::Kelvin(_)
                | Model::Maxwell(_)
                | Model::DoubleSpringMassDamper(_)
                | Model::TripleSpringMassDamper(_),
            ) => "constant stiffness and damping",
            Ok(Model::Own(_)) => "its own law",
            Ok(Model::Chain(_)) => "the last values of its stiffnesses and dampings",
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

/// The test that the candidates are from; of several the one with the deepest crush.
#[derive(Debug, Clone, PartialEq)]
pub struct TestedImpact {
    /// Its impact speed, m/s.
    pub speed_m_per_s: f64,
    /// Slowest and fastest test, m/s; of one test its speed twice.
    pub range_m_per_s: (f64, f64),
    /// Standard deviation of its dynamic crush by the uncertainty of its own speed, zero level, gain and time zero, m.
    pub crush_deviation_m: f64,
    /// What it measured; of several tests nothing.
    pub made: MadeTest,
}

impl TestedImpact {
    /// A test at this speed, with further ones of the same vehicle at these, m/s.
    pub fn new(speed_m_per_s: f64, others_m_per_s: impl IntoIterator<Item = f64>) -> Self {
        let range = (speed_m_per_s, speed_m_per_s);
        let range_m_per_s =
            others_m_per_s.into_iter().fold(range, |(slowest, fastest), v| (slowest.min(v), fastest.max(v)));
        Self { speed_m_per_s, range_m_per_s, crush_deviation_m: 0.0, made: MadeTest::default() }
    }

    /// The test with this standard deviation of its dynamic crush by its inputs, m.
    #[must_use]
    pub fn with_crush_deviation(self, crush_deviation_m: f64) -> Self {
        Self { crush_deviation_m, ..self }
    }

    /// The test with what it measured.
    #[must_use]
    pub fn with_measured(self, made: MadeTest) -> Self {
        Self { made, ..self }
    }

    /// The speed within those of the tests that is nearest to another, m/s.
    pub(crate) fn nearest_m_per_s(&self, speed_m_per_s: f64) -> f64 {
        speed_m_per_s.max(self.range_m_per_s.0).min(self.range_m_per_s.1)
    }
}

/// An impact to be predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scenario {
    /// Impact speed over ground, m/s; zero where only the partner moves.
    pub speed_m_per_s: f64,
    /// Speed of the partner towards the vehicle, m/s, negative where it runs ahead; the wall has none.
    pub partner_speed_m_per_s: f64,
    /// Mass of the vehicle, kg; `None`: that of the test.
    pub mass_kg: Option<f64>,
}

/// What the vehicle runs into.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Partner {
    /// The rigid wall of the test.
    #[default]
    Wall,
    /// A moving barrier: one mass, with a face or rigid.
    Barrier(Structure),
    /// Another vehicle, with the models of a test of its own.
    Vehicle {
        /// Its candidates.
        candidates: Vec<Candidate>,
        /// Place of the one that it is.
        place: usize,
        /// Its test.
        test: TestedImpact,
        /// Its mass, kg; `None`: that of its test.
        mass_kg: Option<f64>,
    },
}

/// What all impacts have in common.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ImpactSetup {
    /// What the vehicle runs into.
    pub partner: Partner,
    /// Who sits in its compartment, behind which restraint.
    pub occupant: Option<Occupant>,
    /// The occupant one standard deviation up and down along each direction in which a fitted restraint may be off.
    pub occupant_ends: Vec<[Occupant; 2]>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_lumped::DoubleSpringMassDamper;

    fn double(k1_n_per_m: f64) -> Candidate {
        let model = DoubleSpringMassDamper {
            m1_kg: 300.0,
            m2_kg: 900.0,
            k1_n_per_m,
            k2_n_per_m: 3e5,
            c1_n_s_per_m: 2e3,
            c2_n_s_per_m: 1e3,
        };
        let model = Ok(Model::DoubleSpringMassDamper(model));
        Candidate { id: "double-spring-mass-damper/direct-fit/1".to_owned(), model, spread: None, weight: 0.0 }
    }

    #[test]
    fn added_mass_is_the_compartments() {
        let masses = |mass_kg| double(4e5).structure(mass_kg).map(|structure| structure.masses_kg().to_vec());
        assert_eq!(masses(None), Ok(vec![300.0, 900.0]));
        assert_eq!(masses(Some(1500.0)), Ok(vec![300.0, 1200.0]));
        assert_eq!(masses(Some(300.0)), Err(PredictError::Mass { asked_kg: 300.0, front_kg: 300.0 }));
    }

    #[test]
    fn a_factor_changes_its_parameter_alone() {
        let factors = [("k1_n_per_m".to_owned(), 2.0)].into();
        assert_eq!(double(4e5).changed(&factors, None), double(8e5).structure(None).ok());
    }
}

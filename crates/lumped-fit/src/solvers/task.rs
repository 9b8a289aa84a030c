//! The task of one solver: model, method, data of the test, settings.

use crumple_lumped::{ModelKind, ParameterKind};
use crumple_signal::Sampled;

use crate::candidate::Method;
use crate::free::search_coordinates::MassFit;
use crate::record::fit_quantity::FitQuantity;
use crate::record::sensor::Sensor;
use crate::record::test_data::TestData;
use crate::solvers::settings::SolveSettings;

/// What a solver works on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    /// The crash events.
    Events,
    /// The motion of the test, and its events where it has them.
    Motion,
    /// An identified model; see [`match_identified`](crate::match_identified).
    IdentifiedModel,
}

/// Everything that a solver is given.
pub(crate) struct Task<'a> {
    /// The model of the row.
    pub model: ModelKind,
    /// The method of the row.
    pub method: Method,
    /// The test.
    pub test: &'a TestData<'a>,
    /// What was asked for: windows, masses, sizes of searches.
    pub settings: &'a SolveSettings,
}

impl Task<'_> {
    /// Whether the displacement of the pulse alone is fitted with given masses, so that the special fits of a model
    /// apply.
    ///
    /// A sensor on a mass that the model does not have changes nothing, nor does naming the pulse itself as a sensor.
    pub(crate) fn fits_displacement_alone(&self) -> bool {
        let count = mass_count(self.model);
        let is_pulse = |sensor: &Sensor<'_>| {
            let pulse: Option<&Sampled> = self.test.displacement.map(|displacement| &**displacement);
            sensor.quantity == FitQuantity::Displacement && pulse == Some(sensor.record)
        };
        self.settings.quantity == FitQuantity::Displacement
            && self.settings.mass_fit == MassFit::Known
            && self
                .test
                .sensors
                .iter()
                .all(|sensor| sensor.place.mass(count).is_none_or(|mass| mass + 1 == count && is_pulse(sensor)))
    }
}

/// How many masses a model has.
pub(crate) fn mass_count(kind: ModelKind) -> usize {
    kind.parameters().iter().filter(|parameter| parameter.kind == ParameterKind::Mass).count()
}

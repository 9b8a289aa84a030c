//! What a model answers: its structure's motions, forces, energies, events and derivatives, in the model's own names.

use crate::families::chain::places_of_constants;
use crate::families::load_paths::CrushedLoadPaths;
use crate::kind::parameter::MOST_KNOTS;
use crate::motion::drive::HORIZON_S;
use crate::structure::connected_masses::Place;
use crate::{CrushEvents, Drive, Dynamics, Instants, LumpedError, Model, ModelKind, Response, Sensitivity};

impl Model {
    /// Where its parameters stand in its [`structure`](Self::structure), in the order of [`ModelKind::parameters`].
    pub fn places(&self) -> Vec<Place> {
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
        }
    }

    /// The model's name in an error of its structure.
    fn named(&self) -> impl Fn(LumpedError) -> LumpedError {
        let model = self.kind();
        move |error| match error {
            LumpedError::ChainDiverges { time_s } => LumpedError::Diverges { model, time_s },
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

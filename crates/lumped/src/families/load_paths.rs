//! Two masses, engine and compartment, behind load paths that are crushed along force-deflection curves.
//!
//! A front has three ways for a force: from the barrier to the engine, from the engine to the compartment, and from the
//! barrier past the engine to the compartment (the rails). Each is a [`ForceDeflection`] with a curve, an unloading and
//! a rate factor of its own; a path that the record does not ask for is left out.
//!
//! One mass behind a structure that is crushed along a force-deflection curve.
//!
//! What a vehicle's front is, mostly: plastic, little dependent on the rate. A curve that is read at one speed holds at
//! another, which a damper's force does not. The law is that of [`ForceDeflection`].

use crate::error::positive;
use crate::kind::{LOAD_PATHS, MOST_KNOTS, MOST_KNOTS_OF_PATH, OF_PATH};
use crate::structure::connected_masses::{Connection, Node, Place, Structure};
use crate::structure::force_deflection::ForceDeflection;
use crate::{LumpedError, ModelKind};

/// What the paths lead from and to, in the order of the parameters.
const ENDS: [(Node, Node); LOAD_PATHS] =
    [(Node::Wall, Node::Mass(0)), (Node::Mass(0), Node::Mass(1)), (Node::Wall, Node::Mass(1))];

/// The curve of one load path: up to [`MOST_KNOTS_OF_PATH`] knots beside that at zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadPath {
    /// Unloading stiffness, N/m; at least the steepest slope of the curve.
    pub unloading_n_per_m: f64,
    /// Rate factor, s/m: the loading force is `1 + r w` times the curve.
    pub rate_s_per_m: f64,
    knots: usize,
    forces_n: [f64; MOST_KNOTS_OF_PATH],
    deflections_m: [f64; MOST_KNOTS_OF_PATH],
}

impl LoadPath {
    /// With knots `(deflection, force)`, m and N, that at zero left out. Errors: more than [`MOST_KNOTS_OF_PATH`] of
    /// them; what they mean is checked with the structure.
    pub fn new(knots: &[(f64, f64)], unloading_n_per_m: f64, rate_s_per_m: f64) -> Result<Self, LumpedError> {
        if knots.len() > MOST_KNOTS_OF_PATH {
            let expected = "8 or fewer";
            return Err(LumpedError::Value { name: "number of knots", value: knots.len() as f64, expected });
        }
        let (mut forces_n, mut deflections_m) = ([0.0; MOST_KNOTS_OF_PATH], [0.0; MOST_KNOTS_OF_PATH]);
        for (j, (deflection, force)) in knots.iter().enumerate() {
            (deflections_m[j], forces_n[j]) = (*deflection, *force);
        }
        Ok(Self { unloading_n_per_m, rate_s_per_m, knots: knots.len(), forces_n, deflections_m })
    }

    /// Knots `(deflection, force)`, m and N, that at zero first.
    pub fn knots(&self) -> Vec<(f64, f64)> {
        let knots = self.deflections_m.iter().copied().zip(self.forces_n).take(self.knots);
        std::iter::once((0.0, 0.0)).chain(knots).collect()
    }

    /// The element it is. Errors: a curve without meaning.
    pub fn element(&self) -> Result<ForceDeflection, LumpedError> {
        ForceDeflection::new(&self.knots(), self.unloading_n_per_m)?.with_rate(self.rate_s_per_m)
    }

    /// Its parameters; not a number for a knot it does not have.
    fn values(&self) -> impl Iterator<Item = f64> {
        let known = |values: [f64; MOST_KNOTS_OF_PATH], knots: usize| {
            (0..MOST_KNOTS_OF_PATH).map(move |j| if j < knots { values[j] } else { f64::NAN })
        };
        known(self.forces_n, self.knots)
            .chain([self.unloading_n_per_m, self.rate_s_per_m])
            .chain(known(self.deflections_m, self.knots))
    }

    /// The path of these parameters, the first of them at `first` of the family; `None` without a knot. Errors: a knot
    /// with a force or a deflection alone, or after one that is missing; knots without an unloading.
    fn from_values(values: &[f64], first: usize) -> Result<Option<Self>, LumpedError> {
        let (forces, rest) = values.split_at(MOST_KNOTS_OF_PATH);
        let (given, deflections) = rest.split_at(2);
        let is_there = |j: &usize| !(forces[*j].is_nan() && deflections[*j].is_nan());
        let Some(last) = (0..MOST_KNOTS_OF_PATH).rev().find(is_there) else { return Ok(None) };
        let needed = (0..=last).flat_map(|j| [j, MOST_KNOTS_OF_PATH + 2 + j]).chain([MOST_KNOTS_OF_PATH]);
        let names = ModelKind::LoadPaths.parameter_names();
        for place in needed {
            if values[place].is_nan() {
                return Err(LumpedError::MissingParameter { model: ModelKind::LoadPaths, name: names[first + place] });
            }
        }
        let knots: Vec<(f64, f64)> = (0..=last).map(|j| (deflections[j], forces[j])).collect();
        Self::new(&knots, given[0], given[1]).map(Some)
    }
}

/// Engine and compartment, and the load paths between them and the barrier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrushedLoadPaths {
    /// Mass of the engine and what moves with it, kg, positive.
    pub m1_kg: f64,
    /// Mass of the compartment, kg, positive.
    pub m2_kg: f64,
    /// From the barrier to the engine, from the engine to the compartment, from the barrier to the compartment; `None`:
    /// there is no such path.
    pub paths: [Option<LoadPath>; LOAD_PATHS],
}

impl CrushedLoadPaths {
    /// The structure it is. Errors: parameters without meaning, a mass that nothing holds.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        let [front, rear, parallel] = self.paths.map(|path| path.is_some());
        if !(front && (rear || parallel)) {
            let expected = "a front path, and a rear or a parallel one";
            let value = self.paths.iter().flatten().count() as f64;
            return Err(LumpedError::Value { name: "number of load paths", value, expected });
        }
        let present = self.paths.iter().zip(ENDS).filter_map(|(path, ends)| Some((path.as_ref()?, ends)));
        let connection = |(path, (front, rear)): (&LoadPath, (Node, Node))| {
            Ok(Connection { front, rear, element: path.element()?.into() })
        };
        let connections = present.map(connection).collect::<Result<_, LumpedError>>()?;
        Structure::new(vec![self.m1_kg, self.m2_kg], connections)
    }

    /// Its parameters, in the order of [`ModelKind::parameters`]; not a number for knots and paths it does not have.
    pub(crate) fn values(&self) -> Vec<f64> {
        let absent = || std::iter::repeat_n(f64::NAN, OF_PATH).collect::<Vec<_>>();
        let of_path = |path: &Option<LoadPath>| path.map_or_else(absent, |path| path.values().collect());
        [self.m1_kg, self.m2_kg].into_iter().chain(self.paths.iter().flat_map(of_path)).collect()
    }

    /// The model of these parameters. Errors: a knot with a force or a deflection alone, knots without an unloading.
    pub(crate) fn from_values(values: &[f64]) -> Result<Self, LumpedError> {
        let mut paths = [None; LOAD_PATHS];
        for (i, path) in paths.iter_mut().enumerate() {
            let first = 2 + i * OF_PATH;
            *path = LoadPath::from_values(&values[first..first + OF_PATH], first)?;
        }
        Ok(Self { m1_kg: values[0], m2_kg: values[1], paths })
    }

    /// Refuses parameters without meaning: a mass that is not positive, a curve that the element refuses.
    pub fn check(&self) -> Result<(), LumpedError> {
        self.structure().map(drop)
    }

    /// Where these parameters stand in the structure; a knot or a path that it does not have stands nowhere.
    pub(crate) fn places(values: &[f64]) -> Vec<Place> {
        let mut places = vec![Place::Mass(0), Place::Mass(1)];
        let mut connection = 0;
        for path in values[2..].chunks(OF_PATH) {
            let knots = path[..MOST_KNOTS_OF_PATH].iter().filter(|force| !force.is_nan()).count();
            // Force of knot j at 2 (j - 1), its place one further; unloading and rate factor after all of them.
            let of_element = |parameter| Place::Element { connection, parameter };
            places.extend((0..MOST_KNOTS_OF_PATH).map(|j| of_element(2 * j)));
            places.extend([2 * knots, 2 * knots + 1].map(of_element));
            places.extend((0..MOST_KNOTS_OF_PATH).map(|j| of_element(2 * j + 1)));
            connection += usize::from(knots > 0);
        }
        places
    }
}

/// A mass, and the curve of the structure in front of it: up to [`MOST_KNOTS`] knots beside that at zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrushedStructure {
    /// Mass, kg, positive.
    pub mass_kg: f64,
    /// Unloading stiffness, N/m; at least the steepest slope of the curve.
    pub unloading_stiffness_n_per_m: f64,
    /// Rate factor, s/m: the loading force is `1 + r w` times the curve.
    pub rate_s_per_m: f64,
    knots: usize,
    forces_n: [f64; MOST_KNOTS],
    deflections_m: [f64; MOST_KNOTS],
}

impl CrushedStructure {
    /// With knots `(deflection, force)`, m and N, that at zero left out. Errors: more than [`MOST_KNOTS`] of them; what
    /// they mean is checked with the structure.
    pub fn new(
        mass_kg: f64,
        knots: &[(f64, f64)],
        unloading_stiffness_n_per_m: f64,
        rate_s_per_m: f64,
    ) -> Result<Self, LumpedError> {
        if knots.len() > MOST_KNOTS {
            let expected = "14 or fewer";
            return Err(LumpedError::Value { name: "number of knots", value: knots.len() as f64, expected });
        }
        let (mut forces_n, mut deflections_m) = ([0.0; MOST_KNOTS], [0.0; MOST_KNOTS]);
        for (j, (deflection, force)) in knots.iter().enumerate() {
            (deflections_m[j], forces_n[j]) = (*deflection, *force);
        }
        let knots = knots.len();
        Ok(Self { mass_kg, unloading_stiffness_n_per_m, rate_s_per_m, knots, forces_n, deflections_m })
    }

    /// Knots `(deflection, force)`, m and N, that at zero first.
    pub fn knots(&self) -> Vec<(f64, f64)> {
        let knots = self.deflections_m.iter().copied().zip(self.forces_n).take(self.knots);
        std::iter::once((0.0, 0.0)).chain(knots).collect()
    }

    /// The element in front of the mass. Errors: a curve without meaning.
    pub fn element(&self) -> Result<ForceDeflection, LumpedError> {
        ForceDeflection::new(&self.knots(), self.unloading_stiffness_n_per_m)?.with_rate(self.rate_s_per_m)
    }

    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        positive("mass_kg", self.mass_kg)?;
        Structure::row(&[self.mass_kg], [vec![self.element()?.into()]])
    }

    /// Its parameters, in the order of [`ModelKind::parameters`](crate::ModelKind::parameters); not a number for a
    /// knot it does not have.
    pub(crate) fn values(&self) -> Vec<f64> {
        let known = |values: &[f64; MOST_KNOTS]| {
            let values = *values;
            (0..MOST_KNOTS).map(move |j| if j < self.knots { values[j] } else { f64::NAN })
        };
        let given = [self.unloading_stiffness_n_per_m, self.rate_s_per_m];
        std::iter::once(self.mass_kg)
            .chain(known(&self.forces_n))
            .chain(given)
            .chain(known(&self.deflections_m))
            .collect()
    }

    /// The model of these parameters. Errors: a knot with a force or a deflection alone, or after one that is missing.
    pub(crate) fn from_values(values: &[f64]) -> Result<Self, LumpedError> {
        let (forces, rest) = values[1..].split_at(MOST_KNOTS);
        let (given, deflections) = rest.split_at(2);
        let is_there = |j: &usize| !(forces[*j].is_nan() && deflections[*j].is_nan());
        let knots = (0..MOST_KNOTS).rev().find(is_there).map_or(0, |last| last + 1);
        let names = ModelKind::ForceDeflection.parameter_names();
        for j in 0..knots {
            for (value, place) in [(forces[j], 1 + j), (deflections[j], 3 + MOST_KNOTS + j)] {
                if value.is_nan() {
                    let model = ModelKind::ForceDeflection;
                    return Err(LumpedError::MissingParameter { model, name: names[place] });
                }
            }
        }
        let knots: Vec<(f64, f64)> = (0..knots).map(|j| (deflections[j], forces[j])).collect();
        Self::new(values[0], &knots, given[0], given[1])
    }

    /// Refuses parameters without meaning: a mass that is not positive, a curve that the element refuses.
    pub fn check(&self) -> Result<(), LumpedError> {
        self.structure().map(drop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    use crate::Model;

    fn path(force: f64) -> LoadPath {
        LoadPath::new(&[(0.1, force), (0.4, 1.5 * force)], 30.0 * force, 0.008).unwrap()
    }

    #[test]
    fn a_path_that_is_not_there_has_no_parameters_and_the_others_read_back() {
        let model = CrushedLoadPaths { m1_kg: 300.0, m2_kg: 1100.0, paths: [Some(path(2e5)), None, Some(path(1e5))] };
        let named = Model::LoadPaths(model).parameters();
        assert_eq!(named.len(), 2 + 2 * 6);
        assert_eq!(named["parallel_knot2_n"], 1.5e5);
        assert_eq!(Model::from_parameters(ModelKind::ForceDeflection, &named), Ok(Model::LoadPaths(model)));
        assert_eq!(model.structure().unwrap().connections().len(), 2);
    }

    #[test]
    fn an_engine_that_nothing_holds_and_half_a_knot_are_refused() {
        let model = CrushedLoadPaths { m1_kg: 300.0, m2_kg: 1100.0, paths: [None, Some(path(2e5)), None] };
        assert!(model.structure().is_err());
        let mut named: BTreeMap<String, f64> =
            Model::LoadPaths(CrushedLoadPaths { paths: [Some(path(2e5)), Some(path(3e5)), None], ..model })
                .parameters();
        named.remove("rear_knot2_m");
        let error = Model::from_parameters(ModelKind::ForceDeflection, &named).unwrap_err();
        assert_eq!(error.to_string(), "model force-deflection needs the parameter rear_knot2_m");
    }
}

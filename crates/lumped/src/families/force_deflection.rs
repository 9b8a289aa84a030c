//! One mass behind a structure that is crushed along a force-deflection curve.
//!
//! What a vehicle's front is, mostly: plastic, little dependent on the rate. A curve that is read at one speed holds at
//! another, which a damper's force does not. The law is that of [`ForceDeflection`].

use crate::error::positive;
use crate::kind::MOST_KNOTS;
use crate::structure::connected_masses::Structure;
use crate::structure::elements::force_deflection::ForceDeflection;
use crate::{LumpedError, ModelKind};

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

//! Motions at chosen instants with their derivatives by the parameters, for fits.
//!
//! A fit by least squares needs the derivative of every sample by every parameter. Each family has its own way to them,
//! all analytic; a test compares each with central differences. Parameters are counted as in
//! [`ModelKind::parameters`](crate::ModelKind::parameters).

use crate::exact::linear_motion::{chain, maxwell};
use crate::families::elastoplastic::sensitivity::elastoplastic;
use crate::{Instants, LumpedError, Model, Motion, Sensitivity};

impl Model {
    /// The motion of every mass at these instants, and its derivatives by the parameters at these places of
    /// [`ModelKind::parameter_names`](crate::ModelKind::parameter_names).
    ///
    /// Analytic throughout, right to rounding: Kelvin, Maxwell and the chains by the derivative of the matrix
    /// exponential, the elastoplastic model by differentiating its closed form, the nonlinear ones by the variational
    /// equation, solved by Taylor series along with the motion. (Their forces are continuous where they have a kink, so
    /// nothing jumps there.) An acceleration of the nonlinear models has a kink at a knot, where one of the two
    /// one-sided derivatives is given. Errors: parameters without meaning, a place that is none, a motion that leaves
    /// the range of numbers.
    pub fn sensitivity(
        &self,
        impact_speed_m_per_s: f64,
        at: &Instants,
        parameters: &[usize],
    ) -> Result<Sensitivity, LumpedError> {
        self.check()?;
        let names = self.kind().parameter_names();
        if let Some(place) = parameters.iter().find(|p| **p >= names.len()) {
            let expected = "the place of a parameter of the model";
            return Err(LumpedError::Value { name: "parameter", value: *place as f64, expected });
        }
        let v0 = impact_speed_m_per_s;
        let sensitivity = match self {
            Self::Kelvin(m) => {
                chain([&[m.mass_kg], &[m.stiffness_n_per_m], &[m.damping_n_s_per_m]], parameters, v0, at)
            }
            Self::Maxwell(m) => maxwell([m.mass_kg, m.stiffness_n_per_m, m.damping_n_s_per_m], parameters, v0, at),
            Self::DoubleSpringMassDamper(m) => {
                let (springs, dampers) = ([m.k1_n_per_m, m.k2_n_per_m], [m.c1_n_s_per_m, m.c2_n_s_per_m]);
                chain([&[m.m1_kg, m.m2_kg], &springs, &dampers], parameters, v0, at)
            }
            Self::TripleSpringMassDamper(m) => {
                chain([&m.masses_kg, &m.springs_n_per_m, &m.dampers_n_s_per_m], parameters, v0, at)
            }
            Self::Elastoplastic(m) => elastoplastic(m, v0, at, parameters),
            Self::Nonlinear1(m) => m.law().sensitivity(v0, at, parameters)?,
            Self::Nonlinear2(m) => m.law().sensitivity(v0, at, parameters)?,
        };
        let motions = || sensitivity.motions.iter().chain(sensitivity.derivatives.iter().flatten());
        if let Some(k) = motions().filter_map(Motion::first_not_finite).min() {
            return Err(LumpedError::Diverges { model: self.kind(), time_s: at.first_s + k as f64 * at.dt_s });
        }
        Ok(sensitivity)
    }
}

//! A model of any family and its response to an impact.
//!
//! [`Model`] is the one type that candidates, fits and simulations hold: whatever the family, it checks its parameters,
//! knows its masses and events and responds to an impact. What a family is made of is in `families/`.

use crate::error::positive;
use crate::exact::exact_step::exact_step;
use crate::exact::linear_motion::chain;
use crate::{
    CrushEvents, DoubleSpringMassDamper, Elastoplastic, Instants, Kelvin, LumpedError, Maxwell, ModelKind, Motion,
    Nonlinear1, Nonlinear2, Response, TripleSpringMassDamper,
};

/// A lumped model with its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
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
        }
    }

    /// Refuses parameters for which the model has no meaning: masses that are not positive, numbers that are not
    /// finite. Negative springs and dampers pass where the equations allow them: solvers do return such sets.
    pub fn check(&self) -> Result<(), LumpedError> {
        match self {
            Self::Kelvin(m) => m.check(),
            Self::Elastoplastic(m) => m.check(),
            Self::Maxwell(m) => m.check(),
            Self::Nonlinear1(m) => m.check(),
            Self::Nonlinear2(m) => m.check(),
            Self::DoubleSpringMassDamper(m) => m.check(),
            Self::TripleSpringMassDamper(m) => m.check(),
        }
    }

    /// Masses from the barrier on, kg.
    pub fn masses_kg(&self) -> Vec<f64> {
        match self {
            Self::Kelvin(m) => vec![m.mass_kg],
            Self::Elastoplastic(m) => vec![m.mass_kg],
            Self::Maxwell(m) => vec![m.mass_kg],
            Self::Nonlinear1(m) => vec![m.mass_kg],
            Self::Nonlinear2(m) => vec![m.mass_kg],
            Self::DoubleSpringMassDamper(m) => vec![m.m1_kg, m.m2_kg],
            Self::TripleSpringMassDamper(m) => m.masses_kg.to_vec(),
        }
    }

    /// Events of the compartment, from the exact solution.
    pub fn events(&self, impact_speed_m_per_s: f64) -> Result<CrushEvents, LumpedError> {
        self.check()?;
        Ok(match self {
            Self::Kelvin(m) => m.events(impact_speed_m_per_s),
            Self::Elastoplastic(m) => m.events(impact_speed_m_per_s),
            Self::Maxwell(m) => m.events(impact_speed_m_per_s),
            Self::Nonlinear1(m) => m.events(impact_speed_m_per_s)?,
            Self::Nonlinear2(m) => m.events(impact_speed_m_per_s)?,
            Self::DoubleSpringMassDamper(m) => m.events(impact_speed_m_per_s)?[1],
            Self::TripleSpringMassDamper(m) => m.events(impact_speed_m_per_s)?[2],
        })
    }

    /// The motion of every mass at `t = k·dt_s`, k = 0 .. `samples`, from contact at `impact_speed_m_per_s`.
    ///
    /// Exact: single masses by closed form at every sample; the double model by repeated multiplication with one
    /// matrix exponential, whose rounding grows to about `samples·1e-16` of the largest motion. Errors: parameters
    /// without meaning, or a response that leaves the range of numbers.
    pub fn respond(&self, impact_speed_m_per_s: f64, dt_s: f64, samples: usize) -> Result<Response, LumpedError> {
        self.check()?;
        let v0 = impact_speed_m_per_s;
        let (masses_kg, motions) = match self {
            Self::Kelvin(m) => (vec![m.mass_kg], vec![sample(dt_s, samples, |t| m.state(v0, t))]),
            Self::Elastoplastic(m) => (vec![m.mass_kg], vec![sample(dt_s, samples, |t| m.state(v0, t))]),
            Self::Maxwell(m) => (vec![m.mass_kg], vec![sample(dt_s, samples, |t| m.state(v0, t))]),
            Self::Nonlinear1(m) => (vec![m.mass_kg], vec![m.motion(v0, dt_s, samples)?]),
            Self::Nonlinear2(m) => (vec![m.mass_kg], vec![m.motion(v0, dt_s, samples)?]),
            Self::TripleSpringMassDamper(m) => {
                positive("dt_s", dt_s)?;
                let values = [&m.masses_kg[..], &m.springs_n_per_m, &m.dampers_n_s_per_m];
                let sensitivity = chain(values, &[], v0, &Instants { first_s: 0.0, dt_s, samples });
                (m.masses_kg.to_vec(), sensitivity.motions)
            }
            Self::DoubleSpringMassDamper(m) => (vec![m.m1_kg, m.m2_kg], march(m, v0, dt_s, samples)),
        };
        if let Some(k) = motions.iter().filter_map(Motion::first_not_finite).min() {
            return Err(LumpedError::Diverges { model: self.kind(), time_s: k as f64 * dt_s });
        }
        Ok(Response { dt_s, masses_kg, motions })
    }
}

/// A closed form at `k dt`, k = 0 .. `samples`.
fn sample(dt_s: f64, samples: usize, state: impl Fn(f64) -> crate::State) -> Motion {
    let mut motion = Motion::with_capacity(samples);
    for k in 0..samples {
        motion.push(state(k as f64 * dt_s));
    }
    motion
}

/// The motion of chassis and compartment: `z((k + 1) dt) = exp(A dt) z(k dt)`, accelerations from the rows of `A`. One
/// rounding a sample, which grows to about `samples 1e-16` of the largest motion.
fn march(model: &DoubleSpringMassDamper, v0: f64, dt_s: f64, samples: usize) -> Vec<Motion> {
    let a = model.state_matrix();
    let phi = exact_step(&a, dt_s);
    let mut motions = [Motion::zeros(samples), Motion::zeros(samples)];
    let [chassis, compartment] = &mut motions;
    // Rows by rows on plain arrays: the loop is a chain of one product, and everything else fits beside it.
    let row = |m: &nalgebra::Matrix4<f64>, i: usize, z: &[f64; 4]| {
        (m[(i, 0)] * z[0] + m[(i, 1)] * z[1]) + (m[(i, 2)] * z[2] + m[(i, 3)] * z[3])
    };
    let mut z: [f64; 4] = DoubleSpringMassDamper::start(v0).into();
    let first =
        chassis.displacement_m.iter_mut().zip(&mut chassis.velocity_m_per_s).zip(&mut chassis.acceleration_m_per_s2);
    let second = compartment
        .displacement_m
        .iter_mut()
        .zip(&mut compartment.velocity_m_per_s)
        .zip(&mut compartment.acceleration_m_per_s2);
    for (((x1, v1), a1), ((x2, v2), a2)) in first.zip(second) {
        (*x1, *x2, *v1, *v2) = (z[0], z[1], z[2], z[3]);
        (*a1, *a2) = (row(&a, 2, &z), row(&a, 3, &z));
        z = std::array::from_fn(|i| row(&phi, i, &z));
    }
    motions.into()
}

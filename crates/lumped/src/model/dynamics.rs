//! Everything a model does: the motion of every mass, the force in every spring and damper, and where the energy is.
//!
//! The response of a model (`lumped_model.rs`) is its motion alone; here come the force in every element and the
//! balance of energy, which is a check of the motion: kinetic + stored + dissipated = brought in. Heat and work are
//! integrated by themselves, never taken as what is left over.
//!
//! - Kelvin, double, triple: as a [`Chain`], quadratic forms integrated exactly over a step.
//! - Maxwell: three states of its own, the same walk ([`Driven`]).
//! - Nonlinear models: spring work in closed form over the pieces, heat term by term on the Taylor series; under a
//!   force or a moving barrier as a [`SecantChain`] of one mass.
//! - Elastoplastic: stored `F²/(2 k_P)`, what it would give back on the unloading line; the rest of the work on the
//!   spring counts as dissipated at once.

use nalgebra::DMatrix;

use crate::exact::driven::{Driven, Instant};
use crate::secant::single_mass::SecantMotion;
use crate::{
    Chain, DoubleSpringMassDamper, Drive, Dynamics, ElementForce, Energy, Kelvin, LumpedError, Maxwell, Model,
    ModelKind, Motion, PiecewiseLinear, Response, SecantChain, State,
};

impl Model {
    /// Motions, forces and energies at `k dt`, k = 0 .. `samples`.
    ///
    /// After an impact the motions are those of [`Model::respond`]. Under a force or a base motion the nonlinear models
    /// go as a [`SecantChain`] of one mass, and the elastoplastic one from event to event. That one stores what it
    /// would give back along the unloading line; the rest of the work on its spring counts as dissipated at once.
    /// Errors: as [`Model::respond`], and a drive that is not finite or acts on a mass that is not there.
    pub fn dynamics(&self, drive: &Drive, dt_s: f64, samples: usize) -> Result<Dynamics, LumpedError> {
        self.check()?;
        let Drive::Impact(speed) = drive else {
            return match self {
                Self::Elastoplastic(m) => m.driven(drive, dt_s, samples),
                Self::Maxwell(m) => maxwell(m, drive, dt_s, samples),
                Self::Nonlinear1(m) => driven_secant(self.kind(), &m.law(), drive, dt_s, samples),
                Self::Nonlinear2(m) => driven_secant(self.kind(), &m.law(), drive, dt_s, samples),
                Self::Kelvin(m) => chained(self.kind(), &kelvin_chain(m)?, drive, dt_s, samples),
                Self::DoubleSpringMassDamper(m) => chained(self.kind(), &double_chain(m)?, drive, dt_s, samples),
                Self::TripleSpringMassDamper(m) => chained(self.kind(), &m.chain()?, drive, dt_s, samples),
            };
        };
        let response = self.respond(*speed, dt_s, samples)?;
        match self {
            Self::Maxwell(m) => Ok(Dynamics { response, ..maxwell(m, drive, dt_s, samples)? }),
            Self::Elastoplastic(m) => {
                let motion = response.compartment();
                let force_n: Vec<f64> = motion.acceleration_m_per_s2.iter().map(|a| -m.mass_kg * a).collect();
                let (stiff, soft) = (m.unloading_stiffness_n_per_m, m.loading_stiffness_n_per_m);
                let plastic = |x: f64| 0.5 * soft * x * x * (1.0 - soft / stiff);
                let crush = m.events(*speed);
                let (t_m, c) =
                    (crush.time_of_dynamic_crush_s.unwrap_or_default(), crush.dynamic_crush_m.unwrap_or_default());
                let energy = (0..samples)
                    .map(|k| {
                        let x = if k as f64 * dt_s <= t_m { motion.displacement_m[k] } else { c };
                        Energy {
                            kinetic_j: 0.5 * m.mass_kg * motion.velocity_m_per_s[k].powi(2),
                            stored_j: 0.5 * force_n[k].powi(2) / stiff,
                            dissipated_j: plastic(x),
                            input_j: 0.5 * m.mass_kg * speed.powi(2),
                        }
                    })
                    .collect();
                let deflection_m = motion.displacement_m.clone();
                Ok(Dynamics {
                    forces: vec![ElementForce { name: "k".to_owned(), force_n, deflection_m }],
                    energy,
                    response,
                })
            }
            Self::Nonlinear1(m) => secant(&m.law(), *speed, dt_s, response),
            Self::Nonlinear2(m) => secant(&m.law(), *speed, dt_s, response),
            Self::Kelvin(m) => {
                Ok(Dynamics { response, ..chained(self.kind(), &kelvin_chain(m)?, drive, dt_s, samples)? })
            }
            Self::DoubleSpringMassDamper(m) => {
                Ok(Dynamics { response, ..chained(self.kind(), &double_chain(m)?, drive, dt_s, samples)? })
            }
            Self::TripleSpringMassDamper(m) => {
                Ok(Dynamics { response, ..chained(self.kind(), &m.chain()?, drive, dt_s, samples)? })
            }
        }
    }

    /// The model as a chain of masses, where it is one.
    ///
    /// Kelvin is a chain of one mass. `None` for the families that are none: their force is no sum of a constant spring
    /// and a constant damper in parallel. Errors: parameters without meaning.
    pub fn chain(&self) -> Result<Option<Chain>, LumpedError> {
        Ok(match self {
            Self::Kelvin(m) => Some(kelvin_chain(m)?),
            Self::DoubleSpringMassDamper(m) => Some(double_chain(m)?),
            Self::TripleSpringMassDamper(m) => Some(m.chain()?),
            Self::Elastoplastic(_) | Self::Maxwell(_) | Self::Nonlinear1(_) | Self::Nonlinear2(_) => None,
        })
    }
}

/// A chain of one mass.
fn kelvin_chain(m: &Kelvin) -> Result<Chain, LumpedError> {
    Chain::new(&[m.mass_kg], &[m.stiffness_n_per_m], &[m.damping_n_s_per_m])
}

/// A chain of two masses.
fn double_chain(m: &DoubleSpringMassDamper) -> Result<Chain, LumpedError> {
    Chain::new(&[m.m1_kg, m.m2_kg], &[m.k1_n_per_m, m.k2_n_per_m], &[m.c1_n_s_per_m, m.c2_n_s_per_m])
}

/// One mass with knots under a drive.
fn driven_secant(
    model: ModelKind,
    law: &SecantMotion,
    drive: &Drive,
    dt_s: f64,
    samples: usize,
) -> Result<Dynamics, LumpedError> {
    let (spring, damper) = (PiecewiseLinear::new(&law.spring.points())?, PiecewiseLinear::new(&law.damper.points())?);
    let chain = SecantChain::new(&[law.mass_kg], &[spring], &[damper])?;
    chain.dynamics(drive, dt_s, samples).map_err(|error| match error {
        LumpedError::ChainDiverges { time_s } => LumpedError::Diverges { model, time_s },
        other => other,
    })
}

/// The dynamics of a chain, with errors in the name of the model it stands for.
fn chained(model: ModelKind, chain: &Chain, drive: &Drive, dt_s: f64, samples: usize) -> Result<Dynamics, LumpedError> {
    let response = chain.respond(drive, dt_s, samples).map_err(|error| match error {
        LumpedError::Diverges { time_s, .. } => LumpedError::Diverges { model, time_s },
        other => other,
    })?;
    Ok(response.into_dynamics(chain.masses_kg()))
}

/// Spring and damper in series: one force, two deflections. States `x`, `v` and the spring's deflection `F/k`, all of a
/// size.
fn maxwell(m: &Maxwell, drive: &Drive, dt_s: f64, samples: usize) -> Result<Dynamics, LumpedError> {
    let (mass, k, c) = (m.mass_kg, m.stiffness_n_per_m, m.damping_n_s_per_m);
    let [mut a, mut heat, mut work] = [0; 3].map(|_| DMatrix::zeros(7, 7));
    (a[(0, 1)], a[(1, 2)]) = (1.0, -k / mass);
    (a[(2, 1)], a[(2, 4)], a[(2, 2)]) = (1.0, -1.0, -k / c);
    (a[(3, 4)], a[(5, 6)]) = (1.0, 1.0);
    heat[(2, 2)] = k * k / c;
    if let Some((index, _)) = drive.force() {
        if index > 0 {
            return Err(LumpedError::Value { name: "mass", value: index as f64, expected: "0: there is one mass" });
        }
        a[(1, 5)] = 1.0 / mass;
        (work[(1, 5)], work[(5, 1)]) = (0.5, 0.5);
    } else if drive.base().is_some() {
        a[(4, 5)] = 1.0;
        (work[(2, 4)], work[(4, 2)]) = (-0.5 * k, -0.5 * k);
    }
    let mut motion = Motion::with_capacity(samples);
    let mut energy: Vec<Energy> = Vec::with_capacity(samples);
    let [mut force, mut spring, mut damper] = [0; 3].map(|_| Vec::with_capacity(samples));
    let speed = drive.speed_m_per_s();
    let driven = Driven { a, heat, work, model: ModelKind::Maxwell };
    driven.walk(&[0.0, speed, 0.0], drive, dt_s, samples, |Instant { z, rate, dissipated_j, input_j }| {
        motion.push(State { displacement_m: z[0], velocity_m_per_s: z[1], acceleration_m_per_s2: rate[1] });
        force.push(k * z[2]);
        spring.push(z[2]);
        damper.push(z[0] - z[3] - z[2]);
        energy.push(Energy {
            kinetic_j: 0.5 * mass * z[1] * z[1],
            stored_j: 0.5 * k * z[2] * z[2],
            dissipated_j,
            input_j: 0.5 * mass * speed * speed + input_j,
        });
    })?;
    let forces = vec![
        ElementForce { name: "k".to_owned(), force_n: force.clone(), deflection_m: spring },
        ElementForce { name: "c".to_owned(), force_n: force, deflection_m: damper },
    ];
    Ok(Dynamics { response: Response { dt_s, masses_kg: vec![mass], motions: vec![motion] }, forces, energy })
}

/// Forces and energies of a nonlinear model after an impact, from its response.
fn secant(law: &SecantMotion, speed: f64, dt_s: f64, response: Response) -> Result<Dynamics, LumpedError> {
    let motion = response.compartment();
    let heat = law.dissipated(speed, dt_s, motion.displacement_m.len())?;
    let (mut spring, mut damper, mut energy) = (Vec::new(), Vec::new(), Vec::new());
    let states = motion.displacement_m.iter().zip(&motion.velocity_m_per_s);
    for ((x, v), dissipated_j) in states.zip(heat) {
        spring.push(law.spring.value(x.abs()) * x);
        damper.push(law.damper.value(v.abs()) * v);
        energy.push(Energy {
            kinetic_j: 0.5 * law.mass_kg * v * v,
            stored_j: law.spring.work(x.abs()),
            dissipated_j,
            input_j: 0.5 * law.mass_kg * speed * speed,
        });
    }
    let deflection_m = motion.displacement_m.clone();
    let forces = vec![
        ElementForce { name: "k".to_owned(), force_n: spring, deflection_m: deflection_m.clone() },
        ElementForce { name: "c".to_owned(), force_n: damper, deflection_m },
    ];
    Ok(Dynamics { response, forces, energy })
}

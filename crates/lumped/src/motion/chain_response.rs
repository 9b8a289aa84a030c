//! Motion, forces and energies of masses in a row, as their solvers write them.
//!
//! Lists have one entry a sample; the outer lists of motions have one a mass, those of forces one an element, from the
//! barrier on.

use crate::motion::dynamics::{Dynamics, ElementForce, Energy};
use crate::motion::mass_motion::{Motion, Response};

/// Motion, element forces and energies of a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainResponse {
    /// Sampling interval, s.
    pub dt_s: f64,
    /// Motion of every mass, from the barrier on; displacement is absolute.
    pub motions: Vec<Motion>,
    /// Displacement of the barrier, m: zero unless it is driven.
    pub base_m: Vec<f64>,
    /// Force in every spring, N, positive in compression.
    pub spring_force_n: Vec<Vec<f64>>,
    /// Force in every damper, N.
    pub damper_force_n: Vec<Vec<f64>>,
    /// Energy at every sample.
    pub energy: Vec<Energy>,
}

impl ChainResponse {
    /// The same as [`Dynamics`] of any model, with the masses it belongs to.
    pub(crate) fn into_dynamics(self, masses_kg: &[f64]) -> Dynamics {
        let (masses, dt_s) = (masses_kg.len(), self.dt_s);
        let name = |letter: char, i: usize| if masses == 1 { letter.to_string() } else { format!("{letter}{}", i + 1) };
        let mut forces = Vec::with_capacity(2 * masses);
        for (i, (spring, damper)) in self.spring_force_n.into_iter().zip(self.damper_force_n).enumerate() {
            let displacement_m = &self.motions[i].displacement_m;
            let deflection_m: Vec<f64> = match i.checked_sub(1) {
                Some(front) => {
                    displacement_m.iter().zip(&self.motions[front].displacement_m).map(|(x, y)| x - y).collect()
                }
                None => displacement_m.iter().zip(&self.base_m).map(|(x, y)| x - y).collect(),
            };
            forces.push(ElementForce { name: name('k', i), force_n: spring, deflection_m: deflection_m.clone() });
            forces.push(ElementForce { name: name('c', i), force_n: damper, deflection_m });
        }
        let response = Response { dt_s, masses_kg: masses_kg.to_vec(), motions: self.motions };
        Dynamics { response, forces, energy: self.energy }
    }
}

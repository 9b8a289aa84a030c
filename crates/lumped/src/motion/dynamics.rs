//! The motion of every mass, the force in every spring and damper, and where the energy is.

use crate::motion::mass_motion::Response;

/// Where the energy is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energy {
    /// In the masses, J.
    pub kinetic_j: f64,
    /// In the springs, J: what they can give back.
    pub stored_j: f64,
    /// Turned into heat by dampers and plastic deformation so far, J.
    pub dissipated_j: f64,
    /// Brought in by force or base so far, and by the impact speed, J.
    pub input_j: f64,
}

impl Energy {
    /// What the balance lacks: kinetic + stored + dissipated - input, J; rounding only.
    pub fn gap_j(&self) -> f64 {
        self.kinetic_j + self.stored_j + self.dissipated_j - self.input_j
    }
}

/// The force in one spring or damper.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementForce {
    /// `k`, `c`, or with the number of the element from the barrier on: `k2`.
    pub name: String,
    /// Force at every sample, N, positive in compression.
    pub force_n: Vec<f64>,
    /// How far the element is compressed, m.
    pub deflection_m: Vec<f64>,
}

/// Motions, forces and energies of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Dynamics {
    /// The motion of every mass; absolute.
    pub response: Response,
    /// The force in every spring and damper, from the barrier on.
    pub forces: Vec<ElementForce>,
    /// Energy at every sample.
    pub energy: Vec<Energy>,
}

impl Dynamics {
    /// Largest gap of the energy balance over its largest term at any sample (kinetic, stored, dissipated, brought in);
    /// `None` where all are zero.
    ///
    /// Heat and work are integrated by themselves, so this is a check of motion, forces and law together. For a passive
    /// structure no term is larger than the energy brought in. What is left is rounding: some `1e-16` a sample of the
    /// largest term, times the ratio of the largest force to that of the motion where a damper is stiff.
    pub fn energy_closure(&self) -> Option<f64> {
        let terms = |e: &Energy| [e.kinetic_j, e.stored_j, e.dissipated_j, e.input_j].map(f64::abs);
        let largest = self.energy.iter().flat_map(terms).fold(0.0, f64::max);
        let gap = self.energy.iter().map(|e| e.gap_j().abs()).fold(0.0, f64::max);
        (largest > 0.0).then_some(gap / largest)
    }

    /// Whether the motion grows without end: the kinetic energy at the end is above ten times all that was ever brought
    /// in, which no passive structure can have more of than once.
    pub fn diverges(&self) -> bool {
        let brought_in = self.energy.iter().map(|e| e.input_j.abs()).fold(0.0, f64::max);
        self.energy.last().is_some_and(|e| e.kinetic_j > GROWN * brought_in)
    }
}

/// Kinetic energy over the energy brought in from which a motion is said to grow without end.
const GROWN: f64 = 10.0;

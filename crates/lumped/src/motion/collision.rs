//! What happens in a collision: the state of masses and elements at an instant, the turn, the peaks, the events.

use crate::motion::mass_motion::{Response, State};

/// Where the energy of an element is, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ElementEnergy {
    /// What it can give back.
    pub stored_j: f64,
    /// Turned into plastic deformation so far.
    pub plastic_j: f64,
    /// Lost to the rate effect of a structure so far.
    pub rate_j: f64,
    /// Turned into heat by dampers so far.
    pub damped_j: f64,
}

impl ElementEnergy {
    /// Work done on the element so far, J: the sum of all.
    pub fn work_j(&self) -> f64 {
        self.stored_j + self.plastic_j + self.rate_j + self.damped_j
    }
}

/// An element at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementState {
    /// How far it is compressed, its gap taken off, m.
    pub deflection_m: f64,
    /// Force, N, positive in compression.
    pub force_n: f64,
    /// Permanent set after its last turn, m.
    pub permanent_set_m: f64,
    /// Where its energy is.
    pub energy: ElementEnergy,
}

/// Everything at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// After the start, s.
    pub time_s: f64,
    /// Every mass.
    pub masses: Vec<State>,
    /// Every element, as they were joined.
    pub elements: Vec<ElementState>,
    /// `derivatives[p][mass]`: derivatives of displacement, velocity and acceleration by the p-th parameter asked for.
    pub derivatives: Vec<Vec<State>>,
}

/// Where the relative velocity of two bodies is first zero: dynamic crush, or the common velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct Turn {
    /// Their approach since the start, m: dynamic crush, mutual crush.
    pub crush_m: f64,
    /// Everything at that time.
    pub moment: Moment,
    /// Derivative of the time by every parameter asked for; `None` where the relative acceleration is zero, so that
    /// the velocities only touch.
    pub time_by: Option<Vec<f64>>,
    /// Derivative of the crush by every parameter asked for.
    pub crush_by: Vec<f64>,
}

/// A largest value and when it was there first.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Extremum {
    /// After the start, s.
    pub time_s: f64,
    /// In the unit of the quantity.
    pub value: f64,
}

/// What an element comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ElementEvent {
    /// A knot of its curve.
    Knot,
    /// The end of loading.
    Turn,
    /// The end of contact.
    Open,
    /// Contact, for the first time or again.
    Contact,
    /// The curve, after an unloading.
    Reload,
    /// The force limit.
    Cap,
    /// The force falls below the limit again.
    Uncap,
}

impl ElementEvent {
    /// In one word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Knot => "knot",
            Self::Turn => "turn",
            Self::Open => "open",
            Self::Contact => "contact",
            Self::Reload => "reload",
            Self::Cap => "cap",
            Self::Uncap => "uncap",
        }
    }
}

/// A collision from its start to an instant after it.
#[derive(Debug, Clone, PartialEq)]
pub struct Collision {
    /// Masses, kg.
    pub masses_kg: Vec<f64>,
    /// Kinetic energy at the start, J.
    pub kinetic_start_j: f64,
    /// Velocity of the centre of mass at the start, m/s.
    pub velocity_of_centre_of_mass_start_m_per_s: f64,
    /// Dynamic crush or common velocity of the last mass and the body it is seen from; `None` if not reached.
    pub turn: Option<Turn>,
    /// Everything at the instants asked for.
    pub instants: Vec<Moment>,
    /// Everything at the end.
    pub end: Moment,
    /// Largest size of the acceleration of the last mass, m/s².
    pub peak_acceleration: Extremum,
    /// Largest force on the barrier, N; `None` if nothing stands between it and the masses.
    pub peak_wall_force: Option<Extremum>,
    /// When the force on the barrier went to zero for the last time, s; `None` if it did not.
    pub separation_s: Option<f64>,
    /// What the elements came to: instant, s, index of the element, event.
    pub events: Vec<(f64, usize, ElementEvent)>,
}

impl Collision {
    /// Kinetic energy at one time, J.
    pub fn kinetic_j(&self, moment: &Moment) -> f64 {
        let of_mass = |(mass, state): (&f64, &State)| 0.5 * mass * state.velocity_m_per_s.powi(2);
        self.masses_kg.iter().zip(&moment.masses).map(of_mass).sum()
    }

    /// Momentum at one time, N·s.
    pub fn momentum_n_s(&self, moment: &Moment) -> f64 {
        self.masses_kg.iter().zip(&moment.masses).map(|(mass, state)| mass * state.velocity_m_per_s).sum()
    }

    /// Velocity of the centre of mass at one time, m/s.
    pub fn velocity_of_centre_of_mass_m_per_s(&self, moment: &Moment) -> f64 {
        self.momentum_n_s(moment) / self.masses_kg.iter().sum::<f64>()
    }

    /// Coefficient of restitution against the barrier: what of the velocity of the centre of mass comes back after
    /// separation. `None` without one. The least velocity of the compartment alone is another number.
    pub fn coefficient_of_restitution(&self) -> Option<f64> {
        let [before, after] =
            [self.velocity_of_centre_of_mass_start_m_per_s, self.velocity_of_centre_of_mass_m_per_s(&self.end)];
        (self.separation_s.is_some() && before != 0.0).then_some(-after / before)
    }
}

/// An instant of a collision.
#[derive(Debug, Clone, PartialEq)]
pub struct MeetingState {
    /// When, s after contact.
    pub time_s: f64,
    /// All masses then, in the order of the structure.
    pub masses: Vec<State>,
    /// Largest deflection of each element until then, m.
    pub largest_m: Vec<f64>,
}

/// When two compartments have the same velocity, and when they part.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Meeting {
    /// The first zero of their relative velocity; `None`: they do not stop each other.
    pub common: Option<MeetingState>,
    /// The first zero of their relative acceleration after it, where a real contact opens.
    pub parting: Option<MeetingState>,
}

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

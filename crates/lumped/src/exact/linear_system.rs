//! The matrix of a structure whose forces are all linear, and its derivatives by the parameters.
//!
//! State: displacements of the masses, their velocities, the inner states of the elements that have one. Every entry is
//! linear in the forces of the elements, and the rows of velocities are over the masses.

use crate::structure::connected_masses::{Place, Structure};
use crate::structure::form::{Form, Strain};

/// Force and rate of the inner state of an element, with its nodes and the place of the inner state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinearElement {
    pub nodes: [usize; 2],
    pub force: Form,
    /// Rate of the inner state and its row.
    pub inner: Option<(Form, usize)>,
    /// Force of the damper.
    pub damping: Form,
}

/// A structure on the one branch that each of its elements has.
#[derive(Debug, Clone)]
pub(crate) struct LinearSystem<'a> {
    structure: &'a Structure,
    pub elements: Vec<LinearElement>,
    /// Number of masses.
    pub masses: usize,
    /// Number of states. The displacement of the barrier would come next, then its velocity.
    pub states: usize,
}

impl<'a> LinearSystem<'a> {
    /// The system, if the structure is linear for good.
    pub fn new(structure: &'a Structure) -> Option<Self> {
        if !structure.is_linear() {
            return None;
        }
        let masses = structure.masses_kg().len();
        let mut states = 2 * masses;
        let element = |(element, nodes): (&crate::Element, [usize; 2])| {
            let law = element.law();
            let branch = law.start(Strain::default());
            let inner = law.inner_rate().map(|form| {
                states += 1;
                (form, states - 1)
            });
            LinearElement { nodes, force: law.force(&branch), inner, damping: law.damping(&branch) }
        };
        let elements = structure.joined().map(element).collect();
        Some(Self { structure, elements, masses, states })
    }

    /// Masses, kg.
    pub fn masses_kg(&self) -> &[f64] {
        self.structure.masses_kg()
    }

    /// Places of displacement and velocity of a node in the state; those of the barrier beyond it.
    pub fn place_of(&self, node: usize) -> (usize, usize) {
        if node == self.masses { (self.states, self.states + 1) } else { (node, self.masses + node) }
    }

    /// Adds the row of a form of the strain of an element: `add(column, value)`; velocities are times `tau_s`.
    pub fn row(&self, element: &LinearElement, form: &Form, tau_s: f64, add: &mut dyn FnMut(usize, f64)) {
        let [front, rear] = element.nodes.map(|node| self.place_of(node));
        for ((x, v), sign) in [(rear, 1.0), (front, -1.0)] {
            add(x, sign * form.u);
            add(v, sign * form.w / tau_s);
        }
        if let Some((_, row)) = element.inner {
            add(row, form.z);
        }
    }

    /// Adds what an element of force `force` and rate of its inner state `inner` gives to the matrix, in time units of
    /// `tau_s`: `add(row, column, value)`.
    fn element_entries(
        &self,
        element: &LinearElement,
        (force, inner): (&Form, &Form),
        tau_s: f64,
        add: &mut dyn FnMut(usize, usize, f64),
    ) {
        let [front, rear] = element.nodes;
        for (node, sign) in [(rear, -1.0), (front, 1.0)] {
            if node < self.masses {
                let factor = sign * tau_s * tau_s / self.structure.masses_kg()[node];
                self.row(element, force, tau_s, &mut |column, value| add(self.masses + node, column, factor * value));
            }
        }
        if let Some((_, row)) = element.inner {
            self.row(element, inner, tau_s, &mut |column, value| add(row, column, tau_s * value));
        }
    }

    /// Adds the entries of the matrix in time units of `tau_s`: `add(row, column, value)`, columns of the barrier
    /// among them.
    pub fn entries(&self, tau_s: f64, add: &mut dyn FnMut(usize, usize, f64)) {
        for i in 0..self.masses {
            add(i, self.masses + i, 1.0);
        }
        for element in &self.elements {
            let inner = element.inner.map_or(Form::ZERO, |(inner, _)| inner);
            self.element_entries(element, (&element.force, &inner), tau_s, add);
        }
    }

    /// Adds the entries of the derivative of the matrix by a parameter.
    pub fn entries_by(&self, place: Place, tau_s: f64, add: &mut dyn FnMut(usize, usize, f64)) {
        match place {
            Place::Mass(mass) => {
                let per_mass = -1.0 / self.structure.masses_kg()[mass];
                self.entries(tau_s, &mut |row, column, value| {
                    if row == self.masses + mass {
                        add(row, column, per_mass * value);
                    }
                });
            }
            Place::ImpactSpeed | Place::Velocity(_) | Place::Position(_) => {}
            Place::Element { connection, parameter } => {
                let law = self.structure.connections()[connection].element.law();
                let (force, inner) =
                    (law.force_by(&law.start(Strain::default()), parameter), law.inner_rate_by(parameter));
                self.element_entries(&self.elements[connection], (&force, &inner), tau_s, add);
            }
        }
    }

    /// A time unit in which the fastest swing is of size one, s; one second where nothing is stiff.
    ///
    /// The square root of the largest ratio of stiffness to mass is the fastest natural frequency to within a factor
    /// of two; its reciprocal brings positions and scaled velocities to one size.
    pub fn time_unit_s(&self) -> f64 {
        let mut stiffness = vec![0.0; self.masses + 1];
        let mut fastest = 0.0_f64;
        for element in &self.elements {
            for node in element.nodes {
                stiffness[node] += element.force.u + element.force.z;
            }
            fastest = fastest.max(element.inner.map_or(0.0, |(inner, _)| inner.z * inner.z));
        }
        let masses = self.structure.masses_kg();
        let fastest = masses.iter().zip(&stiffness).map(|(m, k)| (k / m).abs()).fold(fastest, f64::max);
        if fastest > 0.0 && fastest.is_finite() { fastest.sqrt().recip() } else { 1.0 }
    }
}

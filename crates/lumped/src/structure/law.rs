//! What an element has to say of itself.
//!
//! An element is a machine of branches. On a branch its force is a [`Form`] of the strain; a branch ends where one of
//! its guards falls through zero. Forces must be continuous there, so that the derivatives of a motion pass through
//! without a jump. What a branch remembers (the permanent set) may depend on parameters: [`Law::set_by`] says how it
//! changes when the branch begins, [`Law::force_by_set`] what that changes in the force.

use crate::motion::collision::ElementEvent;
use crate::structure::form::{Form, Strain};

/// The branch an element is on, and what it remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Branch {
    /// Number of the branch; what it means is the element's own affair.
    pub line: usize,
    /// Permanent set, m.
    pub set: f64,
    /// Largest compression so far, m.
    pub crush: f64,
    /// Plastic work so far, less what the branch itself tells, J.
    pub plastic_j: f64,
}

/// A branch ends where `form` falls through zero; the next one has the number `next`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guard {
    /// Positive on the branch.
    pub form: Form,
    /// The line that follows.
    pub next: usize,
}

/// The law of an element: force, branches, energies, derivatives. SI units; parameters by their place.
pub trait Law {
    /// Number of parameters.
    fn parameters(&self) -> usize;

    /// Whether the force is one linear form, for good.
    fn is_linear(&self) -> bool {
        !self.has_branches()
    }

    /// Whether its force has more than one branch, whatever the values of its parameters.
    fn has_branches(&self) -> bool;

    /// The branch it starts on.
    fn start(&self, _strain: Strain) -> Branch {
        Branch::default()
    }

    /// Force, N, positive in compression.
    fn force(&self, branch: &Branch) -> Form;

    /// Adds the guards of a branch.
    fn guards(&self, _branch: &Branch, _add: &mut dyn FnMut(Guard)) {}

    /// The branch that follows on the line `next`.
    fn enter(&self, branch: &Branch, next: usize, _strain: Strain) -> Branch {
        Branch { line: next, ..*branch }
    }

    /// What a change of branch is, if it is one to tell of.
    fn event(&self, _before: &Branch, _after: &Branch) -> Option<ElementEvent> {
        None
    }

    /// Rate of the inner state, m/s; `None` without one.
    fn inner_rate(&self) -> Option<Form> {
        None
    }

    /// Derivative of the force by a parameter, the memory as it is.
    fn force_by(&self, branch: &Branch, parameter: usize) -> Form;

    /// Derivative of the rate of the inner state by a parameter.
    fn inner_rate_by(&self, _parameter: usize) -> Form {
        Form::ZERO
    }

    /// Derivative of the force by the permanent set.
    fn force_by_set(&self, _branch: &Branch) -> Form {
        Form::ZERO
    }

    /// Derivative of the permanent set, after `before` ended at `strain`, by something that changes the compression
    /// there by `by_u`; `parameter` is the place it has in this element, if it has one. `set` is that derivative
    /// before.
    fn set_by(&self, _before: &Branch, _strain: Strain, _by_u: f64, _parameter: Option<usize>, set: f64) -> f64 {
        set
    }

    /// Energy that it can give back, and energy turned into plastic deformation so far, J.
    fn energies(&self, branch: &Branch, strain: &Strain) -> [f64; 2];

    /// Force of its damper, or what the rate adds to its force, N: heat is this times the rate of the compression less
    /// that of the inner state.
    fn damping(&self, _branch: &Branch) -> Form {
        Form::ZERO
    }

    /// Whether that heat is the rate effect of a structure and not of a damper.
    fn has_rate_effect(&self) -> bool {
        false
    }

    /// Symbols of the parts whose forces are written: springs `k`, dampers `c`.
    fn symbols(&self) -> &'static str;

    /// How far it is deflected, m: the compression, without a gap.
    fn deflection(&self, strain: &Strain) -> f64 {
        strain.u
    }

    /// Deflection of one of its parts, m.
    fn compression(&self, _part: usize, strain: &Strain) -> f64 {
        self.deflection(strain)
    }
}

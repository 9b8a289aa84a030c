//! A secant spring: `k(|u|) u`, linear in `u` or with knots.

use crate::structure::elements::piecewise_linear::PiecewiseLinear;
use crate::structure::form::{Form, Strain};
use crate::structure::law::{Branch, Guard, Law};

/// A spring whose stiffness, N/m, is constant or linear between knots over the compression, m.
///
/// Parameters: value and place of each knot in turn.
#[derive(Debug, Clone, PartialEq)]
pub struct Spring(pub PiecewiseLinear);

impl Law for Spring {
    fn parameters(&self) -> usize {
        2 * self.0.len()
    }

    fn is_linear(&self) -> bool {
        self.0.as_constant().is_some()
    }

    fn has_branches(&self) -> bool {
        self.0.len() > 1
    }

    fn start(&self, s: Strain) -> Branch {
        Branch { line: self.0.line_at(s.u, s.w), ..Branch::default() }
    }

    fn force(&self, branch: &Branch) -> Form {
        let line = self.0.line(branch.line);
        Form { u: line.constant, uu: line.slope, ..Form::ZERO }
    }

    fn guards(&self, branch: &Branch, add: &mut dyn FnMut(Guard)) {
        let line = self.0.line(branch.line);
        if line.low.is_finite() {
            add(Guard { form: Form { constant: -line.low, u: 1.0, ..Form::ZERO }, next: branch.line - 1 });
        }
        if line.high.is_finite() {
            add(Guard { form: Form { constant: line.high, u: -1.0, ..Form::ZERO }, next: branch.line + 1 });
        }
    }

    fn force_by(&self, branch: &Branch, parameter: usize) -> Form {
        let (constant, slope) = self.0.line_by(branch.line, parameter);
        Form { u: constant, uu: slope, ..Form::ZERO }
    }

    fn energies(&self, _: &Branch, strain: Strain) -> [f64; 2] {
        [self.0.energy(strain.u), 0.0]
    }

    fn symbols(&self) -> &'static str {
        "k"
    }
}

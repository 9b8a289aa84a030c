//! A secant damper: `c(|w|) w`, linear in the rate `w` or with knots.

use crate::structure::elements::piecewise_linear::PiecewiseLinear;
use crate::structure::form::{Form, Strain};
use crate::structure::law::{Branch, Guard, Law};

/// A damper whose coefficient, N·s/m, is constant or linear between knots over the rate of the compression, m/s.
///
/// Parameters: value and place of each knot in turn.
#[derive(Debug, Clone, PartialEq)]
pub struct Damper(pub PiecewiseLinear);

impl Law for Damper {
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
        Branch { line: self.0.line_at(s.w, 0.0), ..Branch::default() }
    }

    fn force(&self, branch: &Branch) -> Form {
        let line = self.0.line(branch.line);
        Form { w: line.constant, ww: line.slope, ..Form::ZERO }
    }

    fn guards(&self, branch: &Branch, add: &mut dyn FnMut(Guard)) {
        let line = self.0.line(branch.line);
        if line.low.is_finite() {
            add(Guard { form: Form { constant: -line.low, w: 1.0, ..Form::ZERO }, next: branch.line - 1 });
        }
        if line.high.is_finite() {
            add(Guard { form: Form { constant: line.high, w: -1.0, ..Form::ZERO }, next: branch.line + 1 });
        }
    }

    fn force_by(&self, branch: &Branch, parameter: usize) -> Form {
        let (constant, slope) = self.0.line_by(branch.line, parameter);
        Form { w: constant, ww: slope, ..Form::ZERO }
    }

    fn energies(&self, _: &Branch, _: Strain) -> [f64; 2] {
        [0.0, 0.0]
    }

    fn damping(&self, branch: &Branch) -> Form {
        self.force(branch)
    }

    fn symbols(&self) -> &'static str {
        "c"
    }
}

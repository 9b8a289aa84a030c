//! Secant springs `k(|u|) u` and dampers `c(|w|) w`: one law, over the compression or over its rate.
//!
//! Coefficients are constant or linear between knots. Parameters: value and place of each knot in turn.

use crate::structure::elements::piecewise_linear::PiecewiseLinear;
use crate::structure::form::{Form, Strain};
use crate::structure::law::{Branch, Guard, Law};

/// A spring whose stiffness, N/m, is constant or linear between knots over the compression, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Spring(pub PiecewiseLinear);

/// A damper whose coefficient, N·s/m, is constant or linear between knots over the rate of the compression, m/s.
#[derive(Debug, Clone, PartialEq)]
pub struct Damper(pub PiecewiseLinear);

/// The law of an element over one of what it feels, with the term of its square in a force; `$symbol`: of its force;
/// `$start`: what it feels at the start, and where that goes.
macro_rules! secant_law {
    ($element:ident, $felt:ident, $square:ident, $symbol:literal, $start:expr, { $($own:item)* }) => {
        impl Law for $element {
            fn parameters(&self) -> usize {
                2 * self.0.len()
            }

            fn is_linear(&self) -> bool {
                self.0.as_constant().is_some()
            }

            fn has_branches(&self) -> bool {
                self.0.len() > 1
            }

            fn start(&self, strain: Strain) -> Branch {
                let (felt, towards) = $start(strain);
                Branch { line: self.0.line_at(felt, towards), ..Branch::default() }
            }

            fn force(&self, branch: &Branch) -> Form {
                let line = self.0.line(branch.line);
                Form { $felt: line.constant, $square: line.slope, ..Form::ZERO }
            }

            fn guards(&self, branch: &Branch, add: &mut dyn FnMut(Guard)) {
                let line = self.0.line(branch.line);
                if line.low.is_finite() {
                    add(Guard { form: Form { constant: -line.low, $felt: 1.0, ..Form::ZERO }, next: branch.line - 1 });
                }
                if line.high.is_finite() {
                    add(Guard { form: Form { constant: line.high, $felt: -1.0, ..Form::ZERO }, next: branch.line + 1 });
                }
            }

            fn force_by(&self, branch: &Branch, parameter: usize) -> Form {
                let (constant, slope) = self.0.line_by(branch.line, parameter);
                Form { $felt: constant, $square: slope, ..Form::ZERO }
            }

            fn symbols(&self) -> &'static str {
                $symbol
            }

            $($own)*
        }
    };
}

secant_law!(Spring, u, uu, "k", |s: Strain| (s.u, s.w), {
    fn energies(&self, _: &Branch, strain: &Strain) -> [f64; 2] {
        [self.0.energy(strain.u), 0.0]
    }
});

secant_law!(Damper, w, ww, "c", |s: Strain| (s.w, 0.0), {
    fn energies(&self, _: &Branch, _: &Strain) -> [f64; 2] {
        [0.0, 0.0]
    }

    fn damping(&self, branch: &Branch) -> Form {
        self.force(branch)
    }
});

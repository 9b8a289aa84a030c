//! The element whose force a person states: an expression of deflection and rate, and how it unloads.
//!
//! Without an unloading the force goes back along its own law. With one the element keeps its largest deflection `X`:
//! from the turn on the force falls along a line from `f(X, 0)` to zero, stays zero below the permanent set
//! `X - f(X, 0)/ku`, and comes back along the line up to `X`. Of a rigid unloading the line is [`RIGID`] times as steep
//! as the secant to the turn.

use std::sync::Arc;

use crate::structure::connected_masses::{Branch, Form, Guard, Law, Strain};
use crate::structure::expression::Expression;

/// Steepness of a rigid line over the secant: its square root is a restitution of 3 %, below which the line of a record
/// is rigid within its accuracy (`closed_form.rs` of the fits).
const RIGID: f64 = 1e3;

/// How far ahead a choice is looked at, s: a step of a motion is a thousand times as long at least.
const ONWARD_S: f64 = 1e-9;

/// How an element goes back.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Unloading {
    /// Along its own law.
    Elastic,
    /// Along a line of this stiffness, N/m, an expression of the parameters.
    Stiffness(Expression),
    /// Along a line that stands for a rigid one.
    Rigid,
}

/// The law of an element, without values.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ForceLaw {
    /// Force, N, positive in compression.
    pub force: Expression,
    pub unloading: Unloading,
}

/// An element with a force of its own. Parameters: all those of its model, in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnForce {
    law: Arc<ForceLaw>,
    values: Arc<[f64]>,
}

/// Along the law.
const LOADING: usize = 0;
/// On the line of unloading.
const UNLOADING: usize = 1;
/// Below the permanent set, without a force.
const OPEN: usize = 2;
/// The state takes two bits of the number of a branch, the choices of the force those above.
const STATE_BITS: usize = 2;

fn state(branch: &Branch) -> usize {
    branch.line & ((1 << STATE_BITS) - 1)
}

fn choices(branch: &Branch) -> usize {
    branch.line >> STATE_BITS
}

/// Pieces over which a static force is integrated, and the nodes and weights of the five-point rule of Gauss on each
/// (Abramowitz and Stegun, table 25.4): exact to degree nine, and about 1e-6 of the energy where a force has a corner
/// inside a piece.
const PIECES: usize = 32;
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

impl OwnForce {
    pub(crate) fn new(law: Arc<ForceLaw>, values: Arc<[f64]>) -> Self {
        Self { law, values }
    }

    /// Force at rest, N, at a deflection in m while it loads.
    pub fn static_force_n(&self, deflection_m: f64) -> f64 {
        self.force_n(deflection_m, 0.0)
    }

    /// Force, N, at a deflection in m and a rate in m/s while it loads.
    pub fn force_n(&self, deflection_m: f64, rate_m_per_s: f64) -> f64 {
        self.law.force.at(&self.values, deflection_m, rate_m_per_s)
    }

    /// Whether it keeps its largest deflection.
    pub fn is_plastic(&self) -> bool {
        self.law.unloading != Unloading::Elastic
    }

    /// Whether its force depends on the rate.
    pub fn depends_on_rate(&self) -> bool {
        self.law.force.has_rate()
    }

    /// Whether this parameter of the model stands in its law.
    pub fn has_parameter(&self, parameter: usize) -> bool {
        let in_line = matches!(&self.law.unloading, Unloading::Stiffness(line) if line.has_parameter(parameter));
        in_line || self.law.force.has_parameter(parameter)
    }

    /// Stiffness of the unloading from a largest deflection, N/m; `None` where it goes back along its law.
    pub fn unloading_n_per_m(&self, largest_m: f64) -> Option<f64> {
        match &self.law.unloading {
            Unloading::Elastic => None,
            Unloading::Stiffness(line) => Some(line.at(&self.values, 0.0, 0.0)),
            Unloading::Rigid => Some(RIGID * self.static_force_n(largest_m) / largest_m),
        }
    }

    /// Its force with other words for deflection, rate and parameters; `None` where it is too long to be written.
    pub fn written_force(&self, x: &str, v: &str, parameter: &dyn Fn(usize) -> String) -> Option<String> {
        self.law.force.written(x, v, parameter)
    }

    /// Its stiffness of unloading likewise, with the force at rest at the turn, in words: a rigid line is that many
    /// times as steep as the secant.
    pub fn written_unloading(&self, force: &str, x: &str, parameter: &dyn Fn(usize) -> String) -> Option<String> {
        match &self.law.unloading {
            Unloading::Elastic => None,
            Unloading::Stiffness(line) => line.written(x, "0", parameter),
            Unloading::Rigid => Some(format!("{RIGID:?} * {force} / {x}")),
        }
    }

    /// Values of the parameters of its model, and whether each stands in its law.
    pub fn values(&self) -> impl Iterator<Item = (f64, bool)> {
        self.values.iter().enumerate().map(|(place, value)| (*value, self.has_parameter(place)))
    }

    /// Damping, N·s/m, and stiffness, N/m, at a strain while it loads.
    pub(crate) fn slopes(&self, strain: Strain) -> [f64; 2] {
        let gradient = self.law.force.gradient(&self.values, strain.u, strain.w);
        [gradient.by_rate, gradient.by_deflection]
    }

    /// Its law, its parameters and what is chosen on a branch, where the force there is no [`Form`].
    pub(crate) fn expression(&self, branch: &Branch) -> Option<(&Expression, &[f64], usize)> {
        let is_series = state(branch) == LOADING && !self.law.force.is_form();
        is_series.then(|| (&self.law.force, &self.values[..], choices(branch)))
    }

    /// The same of the force at rest, from a deflection on that changes at a rate; `None` where the rate adds nothing.
    pub(crate) fn at_rest(&self, branch: &Branch, u: f64, w: f64) -> Option<(&Expression, &[f64], usize)> {
        if state(branch) != LOADING || !self.depends_on_rate() {
            return None;
        }
        // A choice that turns at the start is that of the way on.
        let taken = self.law.force.choices(&self.values, u + ONWARD_S * w, 0.0);
        Some((&self.law.force, &self.values[..], taken))
    }

    /// Work of the force at rest from zero to a deflection, J.
    fn static_work_j(&self, deflection_m: f64) -> f64 {
        let half = 0.5 * deflection_m / PIECES as f64;
        let piece = |i: usize| {
            let middle = (2 * i + 1) as f64 * half;
            GAUSS.iter().map(|(node, weight)| weight * self.static_force_n(middle + node * half)).sum::<f64>()
        };
        half * (0..PIECES).map(piece).sum::<f64>()
    }

    /// The form of the force while it loads, and its derivative by a parameter.
    fn form(&self, branch: &Branch, by: Option<usize>) -> [Form; 2] {
        let forms = self.law.force.forms(&self.values, choices(branch), by);
        forms.last().copied().unwrap_or([Form::ZERO; 2])
    }

    /// The line of unloading from the largest deflection: stiffness and force there.
    fn line(&self, largest_m: f64) -> (f64, f64) {
        let stiffness = self.unloading_n_per_m(largest_m).unwrap_or_default();
        (stiffness, self.static_force_n(largest_m))
    }

    fn loading(&self, strain: Strain) -> usize {
        LOADING | self.law.force.choices(&self.values, strain.u, strain.w) << STATE_BITS
    }
}

/// `force + stiffness (u - largest)`.
fn line_through(stiffness: f64, force: f64, largest: f64) -> Form {
    Form { u: stiffness, constant: force - stiffness * largest, ..Form::ZERO }
}

impl Law for OwnForce {
    fn parameters(&self) -> usize {
        self.values.len()
    }

    fn is_linear(&self) -> bool {
        let is_free = |form: &Form| form.constant == 0.0;
        let mut by = (0..self.values.len()).map(|p| self.form(&Branch::default(), Some(p)));
        !self.has_branches()
            && self.law.force.is_straight()
            && by.all(|[form, change]| is_free(&form) && is_free(&change))
    }

    fn has_branches(&self) -> bool {
        self.is_plastic() || !self.law.force.tests.is_empty()
    }

    fn start(&self, s: Strain) -> Branch {
        if self.is_plastic() && s.u <= 0.0 && s.w <= 0.0 {
            return Branch { line: OPEN, ..Branch::default() };
        }
        Branch { line: self.loading(s), ..Branch::default() }
    }

    fn force(&self, branch: &Branch) -> Form {
        match state(branch) {
            LOADING if self.law.force.is_form() => self.form(branch, None)[0],
            UNLOADING => {
                let (stiffness, force) = self.line(branch.crush);
                line_through(stiffness, force, branch.crush)
            }
            _ => Form::ZERO,
        }
    }

    fn guards(&self, branch: &Branch, add: &mut dyn FnMut(Guard)) {
        let below = |limit: f64| Form { constant: limit, u: -1.0, ..Form::ZERO };
        match state(branch) {
            LOADING => {
                if self.is_plastic() {
                    add(Guard { form: Form { w: 1.0, ..Form::ZERO }, next: UNLOADING });
                }
                let forms = self.law.force.forms(&self.values, choices(branch), None);
                for (choice, test) in self.law.force.tests.iter().enumerate() {
                    let is_above = choices(branch) >> choice & 1 == 1;
                    let form = Form::ZERO.plus(if is_above { 1.0 } else { -1.0 }, &forms[*test][0]);
                    add(Guard { form, next: branch.line ^ 1 << (choice + STATE_BITS) });
                }
            }
            UNLOADING => {
                add(Guard { form: below(branch.crush), next: LOADING });
                add(Guard { form: Form { constant: -branch.set, u: 1.0, ..Form::ZERO }, next: OPEN });
            }
            _ if branch.crush > 0.0 => add(Guard { form: below(branch.set), next: UNLOADING }),
            // Never touched.
            _ => add(Guard { form: below(0.0), next: LOADING }),
        }
    }

    fn enter(&self, branch: &Branch, next: usize, strain: Strain) -> Branch {
        match (state(branch), next) {
            (LOADING, UNLOADING) if self.is_plastic() => {
                let (stiffness, force) = self.line(strain.u);
                let line = if force > 0.0 && stiffness > 0.0 { UNLOADING } else { OPEN };
                let set = if line == UNLOADING { strain.u - force / stiffness } else { strain.u };
                Branch { line, set, crush: strain.u, ..*branch }
            }
            (UNLOADING | OPEN, LOADING) => Branch { line: self.loading(strain), ..*branch },
            _ => Branch { line: next, ..*branch },
        }
    }

    fn force_by(&self, branch: &Branch, parameter: usize) -> Form {
        match state(branch) {
            LOADING if self.law.force.is_form() => self.form(branch, Some(parameter))[1],
            UNLOADING => {
                let largest = branch.crush;
                let force = self.law.force.gradient(&self.values, largest, 0.0).by_parameter[parameter];
                let stiffness = match &self.law.unloading {
                    Unloading::Stiffness(line) => line.gradient(&self.values, 0.0, 0.0).by_parameter[parameter],
                    _ => RIGID * force / largest,
                };
                line_through(stiffness, force, largest)
            }
            _ => Form::ZERO,
        }
    }

    /// What is remembered, and changes with the parameters, is the largest deflection.
    fn force_by_set(&self, branch: &Branch) -> Form {
        if state(branch) != UNLOADING {
            return Form::ZERO;
        }
        let largest = branch.crush;
        let gradient = self.law.force.gradient(&self.values, largest, 0.0);
        let (stiffness, _) = self.line(largest);
        let change = match self.law.unloading {
            Unloading::Rigid => RIGID * (gradient.by_deflection - gradient.value / largest) / largest,
            _ => 0.0,
        };
        line_through(change, gradient.by_deflection - stiffness, largest)
    }

    fn set_by(&self, before: &Branch, _: Strain, by_u: f64, _: Option<usize>, set: f64) -> f64 {
        if state(before) == LOADING { by_u } else { set }
    }

    fn energies(&self, branch: &Branch, strain: &Strain) -> [f64; 2] {
        let largest = if state(branch) == LOADING { strain.u } else { branch.crush };
        let work = self.static_work_j(largest);
        if !self.is_plastic() {
            return [work, 0.0];
        }
        let (stiffness, force) = self.line(largest);
        let elastic = if stiffness > 0.0 && force > 0.0 { 0.5 * force * force / stiffness } else { 0.0 };
        let stored = match state(branch) {
            LOADING => elastic,
            UNLOADING => 0.5 * self.force(branch).at(*strain).powi(2) / stiffness,
            _ => 0.0,
        };
        [stored, work - elastic]
    }

    fn as_own(&self) -> Option<&OwnForce> {
        Some(self)
    }

    fn symbols(&self) -> &'static str {
        "k"
    }
}

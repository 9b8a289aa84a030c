//! The force-deflection element of a structure that is crushed.
//!
//! Its deflection is `d = u - gap`. Loading follows a curve `F(d)`, linear between knots, times `1 + r w` for the rate
//! `w` of the element itself, not above a force limit; at the turn `w = 0` it goes back along the unloading stiffness
//! to the permanent set `s = d - F/k_u`, where it opens, for it cannot pull. On its way in again the elastic line runs
//! up to the dynamic curve, at the old turn or, with a rate factor, a little beyond it. So the force is continuous
//! wherever a branch ends, and the set never shrinks. The extraction programs for crash tests speak of the same
//! element: Mentzer, "The SISAME Program: Structural Crash Model Extraction and Simulation", NHTSA 2006.

use crate::LumpedError;
use crate::error::{finite, positive};
use crate::motion::collision::ElementEvent;
use crate::structure::connected_masses::{Branch, Form, Guard, Law, Strain};
use crate::structure::crush_curve::{CrushCurve, Extrapolation, Piece};
use crate::structure::piecewise_linear;

/// A structure that is crushed: knots of force over deflection, an unloading stiffness, a rate factor, a gap, a force
/// limit.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceDeflection {
    curve: CrushCurve,
    unloading_n_per_m: f64,
    rate_s_per_m: f64,
    gap_m: f64,
}

/// A parameter of the element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForceDeflectionParameter {
    /// Force at the knot of this number, N; that at zero has the number 0 and no force.
    KnotForce(usize),
    /// Deflection at the knot of this number, m.
    KnotDeflection(usize),
    /// Unloading stiffness, N/m.
    Unloading,
    /// Rate factor, s/m.
    Rate,
    /// Gap, m.
    Gap,
    /// Force limit, N.
    Limit,
    /// Stiffness of its own beyond the last knot, N/m.
    Beyond,
}

/// On the curve; also on a piece that the limit cuts off.
const LOADING: usize = 0;
/// On the limit, which the rate factor alone makes the curve reach.
const CAPPED: usize = 1;
/// On the elastic line up to the last turn.
const ELASTIC: usize = 2;
/// On the elastic line beyond the last turn, below the dynamic curve.
const RETURNING: usize = 3;
/// Without contact.
const OPEN: usize = 4;
/// Without contact, never loaded.
const UNTOUCHED: usize = 5;
/// A branch is a piece of the curve and one of these states.
const STATES: usize = 6;

/// Derivatives of the whole element come after those of the knots.
const OF_ELEMENT: [ForceDeflectionParameter; 5] = [
    ForceDeflectionParameter::Unloading,
    ForceDeflectionParameter::Rate,
    ForceDeflectionParameter::Gap,
    ForceDeflectionParameter::Limit,
    ForceDeflectionParameter::Beyond,
];

impl ForceDeflection {
    /// Knots `(deflection, force)`, m and N, from `(0, 0)` on, and the unloading stiffness, N/m; without rate factor,
    /// gap and limit, beyond the last knot with its slope.
    ///
    /// Errors: fewer than two knots, a first one that is not `(0, 0)`, deflections that do not rise, negative forces,
    /// an unloading stiffness below the steepest slope: unloading would give back more than was put in.
    pub fn new(knots: &[(f64, f64)], unloading_n_per_m: f64) -> Result<Self, LumpedError> {
        let curve = CrushCurve::new(knots.to_vec(), Extrapolation::default(), f64::INFINITY)?;
        Self { curve, unloading_n_per_m, rate_s_per_m: 0.0, gap_m: 0.0 }.checked()
    }

    /// Goes on so beyond the last knot. Errors: a stiffness that is negative or above that of unloading.
    pub fn with_extrapolation(self, beyond: Extrapolation) -> Result<Self, LumpedError> {
        let curve = CrushCurve::new(self.curve.knots, beyond, self.curve.limit_n)?;
        Self { curve, ..self }.checked()
    }

    /// The element with the trend of its whole curve beyond the last knot, as further knots and a stiffness behind
    /// them: a parabola by least squares, to which a trough returns; it never falls. Errors: forces beyond the range of
    /// numbers.
    pub fn with_trend_beyond(&self) -> Result<Self, LumpedError> {
        let (knots, stiffness) = piecewise_linear::beyond(&self.curve.knots, self.unloading_n_per_m);
        let knots = self.curve.knots.iter().copied().chain(knots).collect();
        let curve = CrushCurve::new(knots, Extrapolation::Stiffness(stiffness), self.curve.limit_n)?;
        Self { curve, ..self.clone() }.checked()
    }

    /// With a rate factor, s/m: the loading force is `1 + r w` times the curve. Errors: a negative one.
    pub fn with_rate(self, rate_s_per_m: f64) -> Result<Self, LumpedError> {
        Self { rate_s_per_m, ..self }.checked()
    }

    /// With a gap, m, that closes before the element feels anything. Errors: a negative one.
    pub fn with_gap(self, gap_m: f64) -> Result<Self, LumpedError> {
        Self { gap_m, ..self }.checked()
    }

    /// With a force limit, N. Errors: one that is not positive.
    pub fn with_limit(self, limit_n: f64) -> Result<Self, LumpedError> {
        finite("force limit", limit_n)?;
        let curve = CrushCurve::new(self.curve.knots, self.curve.beyond, limit_n)?;
        Ok(Self { curve, ..self })
    }

    fn checked(self) -> Result<Self, LumpedError> {
        positive("unloading stiffness", self.unloading_n_per_m)?;
        for (name, value) in [("rate factor", self.rate_s_per_m), ("gap", self.gap_m)] {
            finite(name, value)?;
            if value < 0.0 {
                return Err(LumpedError::Value { name, value, expected: "zero or more" });
            }
        }
        // A slope is a quotient of differences, each rounded.
        if self.unloading_n_per_m < self.curve.steepest() * (1.0 - 1e-12) {
            let expected = "at least the steepest slope of the curve";
            return Err(LumpedError::Value { name: "unloading stiffness", value: self.unloading_n_per_m, expected });
        }
        Ok(self)
    }

    /// Knots, m and N.
    pub fn knots(&self) -> &[(f64, f64)] {
        &self.curve.knots
    }

    /// Unloading stiffness, N/m.
    pub fn unloading_n_per_m(&self) -> f64 {
        self.unloading_n_per_m
    }

    /// Rate factor, s/m.
    pub fn rate_s_per_m(&self) -> f64 {
        self.rate_s_per_m
    }

    /// Gap, m.
    pub fn gap_m(&self) -> f64 {
        self.gap_m
    }

    /// Force limit, N, if it has one.
    pub fn limit_n(&self) -> Option<f64> {
        (self.curve.limit_n < f64::INFINITY).then_some(self.curve.limit_n)
    }

    /// How the curve goes on beyond the last knot.
    pub fn extrapolation(&self) -> Extrapolation {
        self.curve.beyond
    }

    /// Static force, N, at a deflection, m: no rate factor, not above the limit.
    pub fn static_force_n(&self, deflection_m: f64) -> f64 {
        if deflection_m > 0.0 {
            self.curve.pieces[self.curve.piece_at(deflection_m)].force_at(deflection_m)
        } else {
            0.0
        }
    }

    /// Work of the static force from zero to a deflection, m, in J.
    pub fn static_work_j(&self, deflection_m: f64) -> f64 {
        let d = deflection_m.max(0.0);
        self.curve.pieces[self.curve.piece_at(d)].energy_at(d)
    }

    /// The place of a parameter, for [`Place::Element`](crate::Place::Element); `None` if the element does not have
    /// it.
    pub fn place_of(&self, parameter: ForceDeflectionParameter) -> Option<usize> {
        let knots = self.curve.knots.len();
        match parameter {
            ForceDeflectionParameter::KnotForce(j) => (0 < j && j < knots).then(|| 2 * (j - 1)),
            ForceDeflectionParameter::KnotDeflection(j) => (0 < j && j < knots).then(|| 2 * (j - 1) + 1),
            ForceDeflectionParameter::Limit if self.limit_n().is_none() => None,
            ForceDeflectionParameter::Beyond if !matches!(self.curve.beyond, Extrapolation::Stiffness(_)) => None,
            other => OF_ELEMENT.iter().position(|one| *one == other).map(|i| 2 * (knots - 1) + i),
        }
    }

    /// The parameter at a place.
    fn parameter_at(&self, place: usize) -> ForceDeflectionParameter {
        let of_knots = 2 * (self.curve.knots.len() - 1);
        match place {
            _ if place >= of_knots => OF_ELEMENT[place - of_knots],
            _ if place.is_multiple_of(2) => ForceDeflectionParameter::KnotForce(place / 2 + 1),
            _ => ForceDeflectionParameter::KnotDeflection(place / 2 + 1),
        }
    }

    /// The pieces of the curve.
    pub(crate) fn pieces(&self) -> &[Piece] {
        &self.curve.pieces
    }

    fn piece(&self, branch: &Branch) -> &Piece {
        &self.curve.pieces[branch.line / STATES]
    }

    /// A line over the deflection as a form of the compression.
    fn line(&self, (constant, slope): (f64, f64)) -> Form {
        Form { constant: constant - slope * self.gap_m, u: slope, ..Form::ZERO }
    }

    /// The static force on a piece.
    fn static_force(&self, piece: &Piece) -> Form {
        self.line((piece.force - piece.slope * piece.low, piece.slope))
    }

    /// What the rate factor adds to a static force.
    fn by_rate(&self, of: &Form) -> Form {
        Form { w: self.rate_s_per_m * of.constant, uw: self.rate_s_per_m * of.u, ..Form::ZERO }
    }

    /// The loading force on a piece, without the limit where it does not hold on all of it.
    fn loading_force(&self, piece: &Piece) -> Form {
        let force = self.static_force(piece);
        if piece.is_limited { force } else { force.plus(1.0, &self.by_rate(&force)) }
    }

    /// The elastic line about a set.
    fn elastic(&self, set: f64) -> Form {
        self.line((-self.unloading_n_per_m * set, self.unloading_n_per_m))
    }

    fn limit(&self) -> Form {
        Form { constant: self.curve.limit_n, ..Form::ZERO }
    }

    /// Whether the rate factor can make the curve reach the limit on a piece.
    fn can_be_capped(&self, piece: &Piece) -> bool {
        self.rate_s_per_m > 0.0 && self.curve.limit_n < f64::INFINITY && !piece.is_limited
    }

    /// Derivative of the static force on a piece by a knot, or by the stiffness beyond them.
    fn static_force_by(&self, piece: &Piece, parameter: ForceDeflectionParameter) -> Form {
        let last = self.curve.knots.len() - 1;
        match parameter {
            ForceDeflectionParameter::Gap => Form { constant: -piece.slope, ..Form::ZERO },
            ForceDeflectionParameter::Limit if piece.is_limited => Form { constant: 1.0, ..Form::ZERO },
            _ if piece.is_limited => Form::ZERO,
            ForceDeflectionParameter::KnotForce(knot) => self.line(self.curve.by_force(piece, knot)),
            ForceDeflectionParameter::KnotDeflection(knot) => self.line(self.curve.by_deflection(piece, knot)),
            ForceDeflectionParameter::Beyond if piece.knot == last => self.line((-self.curve.knots[last].0, 1.0)),
            _ => Form::ZERO,
        }
    }
}

impl Law for ForceDeflection {
    fn parameters(&self) -> usize {
        2 * (self.curve.knots.len() - 1) + OF_ELEMENT.len()
    }

    fn has_branches(&self) -> bool {
        true
    }

    fn start(&self, strain: Strain) -> Branch {
        let d = strain.u - self.gap_m;
        let is_loaded = d > 0.0 || (d == 0.0 && strain.w >= 0.0);
        let line = if is_loaded { STATES * self.curve.piece_at(d) + LOADING } else { UNTOUCHED };
        Branch { line, ..Branch::default() }
    }

    fn force(&self, branch: &Branch) -> Form {
        match branch.line % STATES {
            LOADING => self.loading_force(self.piece(branch)),
            CAPPED => self.limit(),
            ELASTIC | RETURNING => self.elastic(branch.set),
            _ => Form::ZERO,
        }
    }

    fn guards(&self, branch: &Branch, add: &mut dyn FnMut(Guard)) {
        let (piece, state) = (self.piece(branch), branch.line % STATES);
        let first = branch.line - state;
        let mut until = |form: Form, next: usize| add(Guard { form, next });
        let below = |limit: f64| self.line((limit, -1.0));
        if matches!(state, LOADING | CAPPED) {
            until(Form { w: 1.0, ..Form::ZERO }, first + ELASTIC);
        }
        if matches!(state, LOADING | CAPPED | RETURNING) && piece.high < f64::INFINITY {
            let next = &self.curve.pieces[first / STATES + 1];
            let stays = state == RETURNING || (self.can_be_capped(next) && (state == CAPPED || piece.is_limited));
            let capped = if state == RETURNING { RETURNING } else { CAPPED };
            until(below(piece.high), first + STATES + if stays { capped } else { LOADING });
        }
        match state {
            LOADING if self.can_be_capped(piece) => {
                until(self.limit().plus(-1.0, &self.loading_force(piece)), first + CAPPED);
            }
            CAPPED => until(self.loading_force(piece).plus(-1.0, &self.limit()), first + LOADING),
            ELASTIC => {
                until(self.line((-branch.set, 1.0)), first + OPEN);
                // Without a rate factor the line meets the curve where it left it.
                until(below(branch.crush), first + if self.rate_s_per_m > 0.0 { RETURNING } else { LOADING });
            }
            RETURNING => {
                let elastic = self.elastic(branch.set);
                until(self.loading_force(piece).plus(-1.0, &elastic), first + LOADING);
                if self.can_be_capped(piece) {
                    until(self.limit().plus(-1.0, &elastic), first + CAPPED);
                }
            }
            OPEN => until(below(branch.set), first + ELASTIC),
            UNTOUCHED => until(below(0.0), LOADING),
            _ => {}
        }
    }

    fn enter(&self, branch: &Branch, next: usize, strain: Strain) -> Branch {
        let (d, piece) = (strain.u - self.gap_m, self.piece(branch));
        let force = piece.force_at(d);
        // Work that cannot be given back, on the curve up to here.
        let on_curve = piece.energy_at(d) - 0.5 * force * force / self.unloading_n_per_m;
        let after = Branch { line: next, ..*branch };
        match (branch.line % STATES, next % STATES) {
            (LOADING | CAPPED, ELASTIC) => Branch {
                set: d - force / self.unloading_n_per_m,
                crush: d,
                plastic_j: branch.plastic_j + on_curve,
                ..after
            },
            (ELASTIC | RETURNING, LOADING | CAPPED) => {
                // The dynamic curve is met at a force above the static one: what that stored is lost.
                let elastic = self.unloading_n_per_m * (d - branch.set);
                let lost = 0.5 * (elastic * elastic - force * force) / self.unloading_n_per_m;
                Branch { plastic_j: branch.plastic_j + lost - on_curve, ..after }
            }
            _ => after,
        }
    }

    fn event(&self, before: &Branch, after: &Branch) -> Option<ElementEvent> {
        let piece = self.piece(after);
        match (before.line % STATES, after.line % STATES) {
            (LOADING | CAPPED, ELASTIC) => Some(ElementEvent::Turn),
            (was, is @ (LOADING | CAPPED)) if was <= CAPPED && before.line / STATES != after.line / STATES => {
                match (piece.starts_at_knot, piece.is_limited) {
                    (true, _) => Some(ElementEvent::Knot),
                    // Where the rate factor keeps it on the limit anyway, nothing happens.
                    (false, true) => (was == LOADING).then_some(ElementEvent::Cap),
                    (false, false) => (is == LOADING).then_some(ElementEvent::Uncap),
                }
            }
            (LOADING, CAPPED) => Some(ElementEvent::Cap),
            (CAPPED, LOADING) => Some(ElementEvent::Uncap),
            (ELASTIC | RETURNING, LOADING | CAPPED) => Some(ElementEvent::Reload),
            (ELASTIC, OPEN) => Some(ElementEvent::Open),
            (OPEN | UNTOUCHED, _) => Some(ElementEvent::Contact),
            _ => None,
        }
    }

    fn force_by(&self, branch: &Branch, parameter: usize) -> Form {
        let (piece, parameter) = (self.piece(branch), self.parameter_at(parameter));
        match (branch.line % STATES, parameter) {
            (LOADING, ForceDeflectionParameter::Rate) if !piece.is_limited => {
                let force = self.static_force(piece);
                Form { w: force.constant, uw: force.u, ..Form::ZERO }
            }
            (LOADING, _) if piece.is_limited => self.static_force_by(piece, parameter),
            (LOADING, _) => {
                let force = self.static_force_by(piece, parameter);
                force.plus(1.0, &self.by_rate(&force))
            }
            (CAPPED, ForceDeflectionParameter::Limit) => Form { constant: 1.0, ..Form::ZERO },
            (ELASTIC | RETURNING, ForceDeflectionParameter::Unloading) => self.line((-branch.set, 1.0)),
            (ELASTIC | RETURNING, ForceDeflectionParameter::Gap) => {
                Form { constant: -self.unloading_n_per_m, ..Form::ZERO }
            }
            _ => Form::ZERO,
        }
    }

    fn force_by_set(&self, branch: &Branch) -> Form {
        match branch.line % STATES {
            ELASTIC | RETURNING => Form { constant: -self.unloading_n_per_m, ..Form::ZERO },
            _ => Form::ZERO,
        }
    }

    fn set_by(&self, before: &Branch, strain: Strain, by_u: f64, parameter: Option<usize>, set: f64) -> f64 {
        // On the curve nothing is remembered: what is noted at a knot is noted anew at the turn.
        if !matches!(before.line % STATES, LOADING | CAPPED) {
            return set;
        }
        let (piece, stiff) = (self.piece(before), self.unloading_n_per_m);
        let own = match parameter.map(|place| self.parameter_at(place)) {
            Some(ForceDeflectionParameter::Unloading) => piece.force_at(strain.u - self.gap_m) / (stiff * stiff),
            Some(ForceDeflectionParameter::Gap) => piece.slope / stiff - 1.0,
            Some(parameter) => -self.static_force_by(piece, parameter).at(strain) / stiff,
            None => 0.0,
        };
        (1.0 - piece.slope / stiff) * by_u + own
    }

    fn energies(&self, branch: &Branch, strain: &Strain) -> [f64; 2] {
        let d = strain.u - self.gap_m;
        match branch.line % STATES {
            LOADING | CAPPED => {
                let piece = self.piece(branch);
                let stored = 0.5 * piece.force_at(d).powi(2) / self.unloading_n_per_m;
                [stored, branch.plastic_j + piece.energy_at(d) - stored]
            }
            ELASTIC | RETURNING => [0.5 * self.unloading_n_per_m * (d - branch.set).powi(2), branch.plastic_j],
            _ => [0.0, branch.plastic_j],
        }
    }

    fn damping(&self, branch: &Branch) -> Form {
        let (piece, state) = (self.piece(branch), branch.line % STATES);
        match state {
            LOADING if !piece.is_limited => self.by_rate(&self.static_force(piece)),
            CAPPED => self.limit().plus(-1.0, &self.static_force(piece)),
            _ => Form::ZERO,
        }
    }

    fn has_rate_effect(&self) -> bool {
        true
    }

    fn symbols(&self) -> &'static str {
        "k"
    }

    fn deflection(&self, strain: &Strain) -> f64 {
        strain.u - self.gap_m
    }
}

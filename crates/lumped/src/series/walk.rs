//! The walk from event to event.
//!
//! A step ends where a guard of an element falls through zero (Newton's method on the series), so no step contains a
//! kink of a force, and at every sample of a drive, whose slope changes there. What a step costs: some 20² products for
//! each square in a force, an estimate of how far the series holds, and, only where a guard can be met within the step
//! at all, a search for the instant. Stiff dampers shorten the steps to their time constant; after [`MAX_STEPS`] the
//! motion is given up.

use crate::series::changes::Changes;
use crate::series::exit::{LinkGuard, Tolerance, ends_at_once, first_exit};
use crate::series::step::{Entry, Input, Step};
use crate::structure::connected_masses::{Place, Structure};
use crate::{Drive, LumpedError, Start};

/// Steps after which the motion is given up.
const MAX_STEPS: usize = 200_000;

/// A motion on its way.
pub(crate) struct Walk<'a> {
    structure: &'a Structure,
    pub step: Step,
    guards: Vec<LinkGuard>,
    changes: Changes,
}

impl Walk<'_> {
    /// The guards of the branches as they are.
    fn gather_guards(&mut self) {
        self.guards.clear();
        for (link, (connection, branch)) in self.structure.connections().iter().zip(&self.step.branches).enumerate() {
            connection.element.law().guards(branch, &mut |guard| self.guards.push(LinkGuard { link, guard }));
        }
    }

    /// Takes an element to its next branch, at the start of the step to come.
    fn enter(&mut self, exit: LinkGuard) {
        let LinkGuard { link, guard } = exit;
        let (law, strain) = (self.structure.connections()[link].element.law(), self.step.strain_now(link));
        let before = self.step.branches[link];
        self.changes.enter(law, link, &before, strain, self.step.links[link].nodes);
        let after = law.enter(&before, guard.next, strain);
        self.step.entered.push(Entry { link, before, after });
        self.step.branches[link] = after;
        self.step.links[link].law = law.force(&after);
        self.gather_guards();
    }

    /// The series from the values at the start, on the branches that the motion enters; how long it holds.
    fn expand(&mut self, longest_s: f64) -> (f64, Tolerance) {
        let mut tries = 0;
        loop {
            self.step.expand();
            let reach_s = self.step.longest().min(longest_s);
            let near = Tolerance::of_step(&self.step, reach_s);
            tries += 1;
            // Each branch can move the motion onto another; more changes than there are elements decide nothing.
            match ends_at_once(&self.step, &self.guards, reach_s, near) {
                Some(exit) if tries <= 4 * self.step.links.len() + 4 => self.enter(exit),
                _ => return (reach_s, near),
            }
        }
    }

    /// Walks on to `end_s`, see [`walk`].
    pub fn follow(
        &mut self,
        drive: &Drive,
        dt_s: f64,
        end_s: f64,
        mut visit: impl FnMut(&Step, &Changes) -> bool,
    ) -> Result<(), LumpedError> {
        self.gather_guards();
        let mass = drive.force().map(|(mass, _)| mass);
        let mut number = 0;
        for _ in 0..MAX_STEPS {
            let t = self.step.start_s;
            if t >= end_s {
                return Ok(());
            }
            let stretch = drive.stretch(number, dt_s);
            let until = stretch.map_or(end_s, |(_, until)| end_s.min(until));
            self.step.input = stretch.map_or(Input::default(), |(course, _)| Input::of_course(mass, &course, t));
            let (reach_s, near) = self.expand(until - t);
            if !self.step.is_finite() {
                return Err(LumpedError::ChainDiverges { time_s: t });
            }
            let exit = first_exit(&self.step, &self.guards, reach_s, near);
            self.step.length_s = exit.map_or(reach_s, |(tau, _)| tau);
            self.changes.expand(self.structure, &self.step);
            if !visit(&self.step, &self.changes) {
                return Ok(());
            }
            self.step.entered.clear();
            self.changes.advance(self.step.length_s);
            self.step.advance();
            if let Some((_, exit)) = exit {
                self.enter(exit);
            } else if self.step.start_s >= until * (1.0 - f64::EPSILON) {
                self.step.start_s = until;
            }
            if stretch.is_some_and(|(_, until)| self.step.start_s >= until) {
                number += 1;
            }
        }
        Err(LumpedError::ChainDiverges { time_s: self.step.start_s })
    }
}

impl<'a> Walk<'a> {
    /// At the start, with the derivatives by the parameters at `places`.
    pub fn new(structure: &'a Structure, start: &Start, places: &[Place]) -> Self {
        let changes = Changes::at_start(structure, places);
        Self { structure, step: Step::at_start(structure, start), guards: Vec::new(), changes }
    }
}

/// Walks from the start to `end_s`, with the derivatives by the parameters at `places`; `visit` returns whether to go
/// on. The samples of `drive` are `dt_s` apart.
///
/// Errors: a motion that leaves the range of numbers or needs more than 200,000 steps, as
/// [`LumpedError::ChainDiverges`] with the time reached.
pub(crate) fn walk(
    structure: &Structure,
    drive: &Drive,
    dt_s: f64,
    end_s: f64,
    places: &[Place],
    visit: impl FnMut(&Step, &Changes) -> bool,
) -> Result<(), LumpedError> {
    Walk::new(structure, &drive.start(), places).follow(drive, dt_s, end_s, visit)
}

//! The walk from event to event.
//!
//! A step ends where a guard of an element falls through zero (Newton's method on the series), so no step contains a
//! kink of a force, and at every sample of a drive, whose slope changes there. What a step costs: some 20² products for
//! each square in a force, an estimate of how far the series holds, and, only where a guard can be met within the step
//! at all, a search for the instant. Stiff dampers shorten the steps to their time constant; after [`MAX_STEPS`] the
//! motion is given up.

use crate::series::changes::Changes;
use crate::series::exit::{LinkGuard, Tolerance, ends_at_once, first_exit};
use crate::series::step::{Input, Step};
use crate::structure::connected_masses::{Place, Structure};
use crate::{Drive, LumpedError};

/// Steps after which the motion is given up.
const MAX_STEPS: usize = 200_000;

/// A motion on its way.
struct Walk<'a> {
    structure: &'a Structure,
    step: Step,
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
        self.step.branches[link] = law.enter(&before, guard.next, strain);
        self.step.links[link].law = law.force(&self.step.branches[link]);
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
    mut visit: impl FnMut(&Step, &Changes) -> bool,
) -> Result<(), LumpedError> {
    let source = drive.source();
    let at = |k: usize| source.get(k).copied().unwrap_or(0.0);
    let step = Step::at_contact(structure, drive.speed_m_per_s());
    let changes = Changes::at_contact(structure, places);
    let mut walk = Walk { structure, step, guards: Vec::new(), changes };
    walk.gather_guards();
    let mass = drive.force().map(|(mass, _)| mass);
    let mut segment = 0;
    for _ in 0..MAX_STEPS {
        let t = walk.step.start_s;
        if t >= end_s {
            return Ok(());
        }
        let is_driven = segment < source.len();
        let until = if is_driven { end_s.min((segment + 1) as f64 * dt_s) } else { end_s };
        walk.step.input = Input::default();
        if is_driven {
            let slope = (at(segment + 1) - at(segment)) / dt_s;
            walk.step.input = Input { mass, value: at(segment) + slope * (t - segment as f64 * dt_s), slope };
        }
        let (reach_s, near) = walk.expand(until - t);
        if !walk.step.is_finite() {
            return Err(LumpedError::ChainDiverges { time_s: t });
        }
        let exit = first_exit(&walk.step, &walk.guards, reach_s, near);
        walk.step.length_s = exit.map_or(reach_s, |(tau, _)| tau);
        walk.changes.expand(structure, &walk.step);
        if !visit(&walk.step, &walk.changes) {
            return Ok(());
        }
        walk.changes.advance(walk.step.length_s);
        walk.step.advance();
        if let Some((_, exit)) = exit {
            walk.enter(exit);
        } else if walk.step.start_s >= until * (1.0 - f64::EPSILON) {
            walk.step.start_s = until;
        }
        if is_driven && walk.step.start_s >= (segment + 1) as f64 * dt_s {
            segment += 1;
        }
    }
    Err(LumpedError::ChainDiverges { time_s: walk.step.start_s })
}

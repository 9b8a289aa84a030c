//! Dynamic crush and rebound of every mass of a structure.

use crate::exact::crossing;
use crate::exact::linear_system::LinearSystem;
use crate::motion::collision::{Meeting, MeetingState};
use crate::series::step::Step;
use crate::series::walk::walk;
use crate::structure::connected_masses::Structure;
use crate::{CrushEvents, Drive, LumpedError, Start, State};

/// Parts of a step on which a change of sign is looked for.
const PARTS: u32 = 8;

impl Structure {
    /// First zero of the velocity of every mass after an impact, within `horizon_s`, and of its acceleration after it,
    /// on the exact solution of a linear structure and on the series of any other.
    ///
    /// What does not happen until the horizon is none; of a linear structure neither what would happen after all its
    /// modes are dead. Errors: a horizon that is not positive, a motion that cannot be followed.
    pub fn events(&self, impact_speed_m_per_s: f64, horizon_s: f64) -> Result<Vec<CrushEvents>, LumpedError> {
        if horizon_s.is_nan() || horizon_s <= 0.0 {
            return Err(LumpedError::Value { name: "horizon_s", value: horizon_s, expected: "a positive time" });
        }
        if let Some(system) = LinearSystem::new(self) {
            return crossing::events(&system, impact_speed_m_per_s, horizon_s);
        }
        let mut events = vec![CrushEvents::default(); self.masses_kg().len()];
        if impact_speed_m_per_s == 0.0 {
            return Ok(events);
        }
        let direction = impact_speed_m_per_s.signum();
        walk(self, &Drive::Impact(impact_speed_m_per_s), horizon_s, horizon_s, &[], |step, _| {
            for (mass, event) in events.iter_mut().enumerate() {
                let mut from = 0.0;
                if event.time_of_dynamic_crush_s.is_none() {
                    let speed = |state: State| state.velocity_m_per_s * direction;
                    let Some(tau) = zero(step, from, |tau| speed(step.state(mass, tau))) else { continue };
                    event.time_of_dynamic_crush_s = Some(step.start_s + tau);
                    event.dynamic_crush_m = Some(step.state(mass, tau).displacement_m);
                    from = tau;
                }
                let braking = |state: State| -state.acceleration_m_per_s2 * direction;
                if event.time_of_rebound_s.is_none()
                    && let Some(tau) = zero(step, from, |tau| braking(step.state(mass, tau)))
                {
                    event.time_of_rebound_s = Some(step.start_s + tau);
                    event.rebound_velocity_m_per_s = Some(step.state(mass, tau).velocity_m_per_s);
                }
            }
            events.iter().any(|event| event.time_of_rebound_s.is_none())
        })?;
        Ok(events)
    }
}

/// Common velocity and parting of the last mass and of mass `partner`, which it runs into. Errors: a motion that cannot
/// be followed.
pub(crate) fn meeting(
    structure: &Structure,
    start: Start,
    partner: usize,
    horizon_s: f64,
) -> Result<Meeting, LumpedError> {
    let (last, links) = (structure.masses_kg().len() - 1, structure.connections());
    let (mut meeting, mut largest_m) = (Meeting::default(), vec![0.0_f64; links.len()]);
    walk(structure, &Drive::Start(start), horizon_s, horizon_s, &[], |step, _| {
        let relative = |tau: f64, of: fn(State) -> f64| of(step.state(last, tau)) - of(step.state(partner, tau));
        let at = |tau: f64, largest_m: &[f64]| {
            let masses = (0..=last).map(|mass| step.state(mass, tau)).collect();
            MeetingState { time_s: step.start_s + tau, masses, largest_m: largest_m.to_vec() }
        };
        let mut from = 0.0;
        if meeting.common.is_none() {
            let common = zero(step, from, |tau| relative(tau, |state| state.velocity_m_per_s));
            // An element turns where a step ends: what is largest stands at an end.
            for ((largest, connection), link) in largest_m.iter_mut().zip(links).zip(&step.links) {
                let strain = link.strain(common.unwrap_or(step.length_s));
                *largest = largest.max(connection.element.law().deflection(&strain));
            }
            let Some(tau) = common else { return true };
            meeting.common = Some(at(tau, &largest_m));
            from = tau;
        }
        let parting = zero(step, from, |tau| -relative(tau, |state| state.acceleration_m_per_s2));
        meeting.parting = parting.map(|tau| at(tau, &largest_m));
        meeting.parting.is_none()
    })?;
    Ok(meeting)
}

/// The first instant from `from` to the end of the step at which a value is no more positive, by bisection. That it is
/// positive before is given: where a step begins on a zero, the value there is rounding.
fn zero(step: &Step, from: f64, value: impl Fn(f64) -> f64) -> Option<f64> {
    let holds = |tau: f64| value(tau) > 0.0;
    let mut low = from;
    for part in 1..=PARTS {
        let mut high = from + (step.length_s - from) * f64::from(part) / f64::from(PARTS);
        if holds(high) {
            low = high;
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if holds(middle) { low = middle } else { high = middle }
        }
        return Some(high);
    }
    None
}

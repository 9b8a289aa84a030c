//! Uncertain mass, speed, zero level and time zero in closed forms: the formula applied to the events of a changed
//! record.

use std::collections::BTreeMap;

use crumple_lumped::{Model, ParameterKind};

use crate::closed_form::elastoplastic_of_record;
use crate::record::observation::Observation;
use crate::uncertainty::propagation::{InputUncertainty, Propagation, Repetition, over_repetitions, with_errors};
use crate::{kelvin_from_events, unloads_rigidly};

/// The events that a closed form follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FollowedEvents {
    /// Time of dynamic crush, s after contact.
    pub time_of_dynamic_crush_s: f64,
    /// Dynamic crush, m.
    pub dynamic_crush_m: f64,
    /// Coefficient of restitution; 0 without rebound.
    pub coefficient_of_restitution: f64,
}

impl FollowedEvents {
    /// The events of a displacement that is compared at every sample from contact to its end; `None` if it never stops.
    ///
    /// Velocities are differences between samples, which for a displacement summed by trapezoids are means of two
    /// samples of the velocity; their first zero and their minimum after it. Off by `O(dt²)`: only changes of the
    /// events are taken from here.
    pub fn of(record: &Observation) -> Option<Self> {
        let wave = record.waves.first()?;
        let dt = wave.measurement.dt_s * wave.stride as f64;
        let x = &wave.samples;
        let speed = |k: usize| (x[k + 1] - x[k]) / dt;
        let stop = (1..x.len().checked_sub(1)?).find(|&k| speed(k) <= 0.0 && speed(k - 1) > 0.0)?;
        let (before, after) = (speed(stop - 1), speed(stop));
        // From the middle before sample `stop` to the middle after it.
        let share = before / (before - after);
        let time_of_dynamic_crush_s = wave.time_s(stop) + (share - 0.5) * dt;
        // The parabola through the three samples.
        let mean = 0.5 * (before + after);
        let dynamic_crush_m = x[stop] + 0.5 * mean * mean * dt / (before - after);
        let lowest = (stop..x.len() - 1).map(speed).fold(after, f64::min);
        Some(Self {
            time_of_dynamic_crush_s,
            dynamic_crush_m,
            coefficient_of_restitution: -lowest / record.impact_speed_m_per_s,
        })
    }

    /// These events moved as far as those of `record` moved to those of `moved`.
    pub fn moved(&self, record: &Observation, moved: &Observation) -> Option<Self> {
        let (from, to) = (Self::of(record)?, Self::of(moved)?);
        let restitution = to.coefficient_of_restitution - from.coefficient_of_restitution;
        Some(Self {
            time_of_dynamic_crush_s: self.time_of_dynamic_crush_s + to.time_of_dynamic_crush_s
                - from.time_of_dynamic_crush_s,
            dynamic_crush_m: self.dynamic_crush_m + to.dynamic_crush_m - from.dynamic_crush_m,
            coefficient_of_restitution: self.coefficient_of_restitution + restitution,
        })
    }
}

/// Applies the closed form of `model` to events that uncertain inputs change, many times, and takes percentiles.
///
/// Each repetition draws mass, speed, zero level and time zero, changes the record accordingly, reads its events and
/// solves by the same formula: Kelvin from crush and its time, elastoplastic from crush and restitution. Only the
/// change of the events is taken from the record, see [`FollowedEvents::moved`]. `events`: those of the test;
/// `whole`: every sample from contact to the end; `mass_kg`: the mass that the uncertainty of the mass refers to. A
/// repetition without a solution is not counted.
///
/// `None` for a model without a closed form, or with fewer than 20 results.
pub fn propagate_closed_form(
    model: &Model,
    events: &FollowedEvents,
    whole: &Observation,
    mass_kg: f64,
    inputs: &InputUncertainty,
    repetitions: usize,
) -> Option<Propagation> {
    over_repetitions(mass_kg, inputs, (repetitions, 1), |errors| {
        let repetition = with_errors(whole, errors)?;
        repeat_closed_form(model, &events.moved(whole, &repetition.observed)?, &repetition)
    })
}

/// The parameters and the model's crush that the closed form gives for these events.
fn repeat_closed_form(
    model: &Model,
    events: &FollowedEvents,
    repetition: &Repetition,
) -> Option<BTreeMap<String, f64>> {
    let v0 = repetition.observed.impact_speed_m_per_s;
    let crush = events.dynamic_crush_m;
    let solved = match model {
        Model::Kelvin(m) => {
            let mass = m.mass_kg * repetition.mass_ratio;
            Model::Kelvin(kelvin_from_events(mass, v0, events.time_of_dynamic_crush_s, crush).ok()?.model)
        }
        Model::Elastoplastic(m) => {
            let mass = m.mass_kg * repetition.mass_ratio;
            let restitution = events.coefficient_of_restitution;
            Model::Elastoplastic(elastoplastic_of_record(mass, v0, crush, restitution).ok()?.0)
        }
        _ => return None,
    };
    let values = solved.parameters();
    let but_masses = solved.kind().parameters().iter().filter(|p| p.kind != ParameterKind::Mass);
    let mut result: BTreeMap<String, f64> = but_masses.map(|p| (p.name.to_owned(), values[p.name])).collect();
    if matches!(model, Model::Elastoplastic(m) if unloads_rigidly(m)) {
        // A stand-in, and no number of the record.
        result.remove("unloading_stiffness_n_per_m");
    }
    if let Some(crush) = solved.events(v0).ok().and_then(|events| events.dynamic_crush_m) {
        result.insert("dynamic_crush_m".to_owned(), crush);
    }
    Some(result)
}

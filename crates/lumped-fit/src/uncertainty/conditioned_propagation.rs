//! Uncertain inputs of the first nonlinear model under its side conditions: the same constrained fit to a changed
//! record.

use std::collections::BTreeMap;

use crumple_lumped::{Model, Nonlinear1, Parameter, ParameterKind};

use crate::fit::nonlinear::{descend_to_conditions, parts};
use crate::fit::problem::Problem;
use crate::uncertainty::closed_form_propagation::FollowedEvents;
use crate::uncertainty::propagation::{InputUncertainty, Propagation, Repetition, over_repetitions, with_errors};
use crate::{Observation, SingleMassFitOptions};

/// Relative decrease of the cost that is worth another step.
const COST_TOLERANCE: f64 = 1e-7;
/// Relative violation of the conditions on crush and speed at which they are met.
const MET: f64 = 1e-8;

/// Repeats the fit of the first nonlinear model under `k1 <= k2`, `c1 >= c2 >= c3`, `x(t_m) = C` and `v(t_m) = 0`
/// with uncertain inputs, and takes percentiles.
///
/// The estimator of [`fit_nonlinear1`](crate::fit_nonlinear1): crush, its time and the last knots are those of each
/// repetition's record, and the displacement is compared without the filter. Every repetition descends from `model`.
/// With time zero more than 0.25 ms off, another start of the fit could win: the spread is then that of one minimum
/// and too small.
///
/// `events`, `whole`: as for [`propagate_closed_form`](crate::propagate_closed_form); `observed`: the samples
/// compared. A repetition that cannot meet the conditions is not counted. `None` with fewer than 20 results.
pub fn propagate_conditioned(
    model: &Nonlinear1,
    events: &FollowedEvents,
    (observed, whole): (&Observation, &Observation),
    mass_kg: f64,
    inputs: &InputUncertainty,
    repetitions: usize,
) -> Option<Propagation> {
    over_repetitions(mass_kg, inputs, (repetitions, 1), |errors| {
        let moved = events.moved(whole, &with_errors(whole, errors)?.observed)?;
        repeat_conditioned(model, &moved, &with_errors(observed, errors)?)
    })
}

/// One repetition: the parameters scaled to the mass drawn, and the dynamic crush of the model, m. `None` where the
/// conditions are not met.
fn repeat_conditioned(
    model: &Nonlinear1,
    events: &FollowedEvents,
    repetition: &Repetition,
) -> Option<BTreeMap<String, f64>> {
    let record = repetition.observed.waves.first()?;
    let v0 = repetition.observed.impact_speed_m_per_s;
    let options = SingleMassFitOptions {
        mass_kg: model.mass_kg,
        impact_speed_m_per_s: v0,
        crush_m: events.dynamic_crush_m,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        time_zero_s: 0.0,
        from_s: record.time_s(0),
        to_s: None,
        samples: record.samples.len(),
    };
    let (coordinates, observed) = (parts(&options), repetition.observed.clone().exact());
    let start = coordinates.coordinates_of(&Model::Nonlinear1(*model));
    let problem = Problem { unit: options.crush_m, ..Problem::new(&coordinates, &observed, 0.0) };
    let (end, _, met) = descend_to_conditions(&problem, &options, &start, (COST_TOLERANCE, MET))?;
    let fitted = coordinates.model(&end.theta).filter(|_| met)?;
    let values = fitted.parameters();
    let free = fitted.kind().parameters().iter().filter(|p| !(p.of_the_test || p.kind == ParameterKind::Mass));
    let scaled = |p: &Parameter| {
        let ratio = if p.kind == ParameterKind::Rate { 1.0 } else { repetition.mass_ratio };
        (p.name.to_owned(), values[p.name] * ratio)
    };
    let mut result: BTreeMap<String, f64> = free.map(scaled).collect();
    if let Some(crush) = fitted.events(v0).ok().and_then(|events| events.dynamic_crush_m) {
        result.insert("dynamic_crush_m".to_owned(), crush);
    }
    Some(result)
}

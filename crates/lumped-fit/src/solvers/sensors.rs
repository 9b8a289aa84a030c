//! Any model fitted to acceleration, velocity or displacement of one or several sensors.

use crumple_lumped::{Model, ModelKind, Parameter, ParameterKind};
use crumple_numerics::estimation::minimise::levenberg_marquardt::{Optimum, descend};
use crumple_signal::Notes;

use crate::fit::descents::{APART, bounds};
use crate::fit::options::SingleMassFitOptions;
use crate::fit::problem::Problem;
use crate::fit::search::{Search, Searched, search};
use crate::free::coordinates::Coordinates;
use crate::free::search_coordinates::Scale;
use crate::solvers::explanations::{Ends, explanations, pairs};
use crate::solvers::fitting::{FitStart, Fitting};
use crate::solvers::task::{Task, mass_count};
use crate::{
    Candidate, MassEvidence, MassFit, Method, SolveError, elastoplastic_from_events, fit_nonlinear1,
    kelvin_from_events, masses, search_nonlinear2, triple_masses,
};

/// The fit of the table: a search on the motion itself, by descents or by L-SHADE, then the fit as measured.
///
/// The window ends with dynamic crush, or with rebound for the elastoplastic model, whose unloading shows only after
/// the crush. Noise levels that are not stated are found from the residuals. A start is the closed form of the
/// events, or the fit of the nonlinear model to the displacement, beside evenly spread ones. Errors: masses without
/// meaning, a window outside a record.
pub(crate) fn fit(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    let (kind, test, settings) = (task.model, task.test, task.settings);
    let (masses_kg, split) = match kind {
        ModelKind::DoubleSpringMassDamper => {
            let (m1, m2, text) = masses(test.mass_kg, settings.split, mass_evidence(task))?;
            (vec![m1, m2], Some(text))
        }
        ModelKind::TripleSpringMassDamper => {
            let (masses, text) = triple_masses(test.mass_kg, settings.split, settings.triple, mass_evidence(task))?;
            (masses.to_vec(), Some(text))
        }
        _ => (vec![test.mass_kg], None),
    };
    let to_s = window_end(task);
    let Some(mut fitting) = Fitting::of_sensors(task, to_s, notes)? else { return Ok(Vec::new()) };
    let is_chain = matches!(kind, ModelKind::DoubleSpringMassDamper | ModelKind::TripleSpringMassDamper);
    if to_s.is_none() && is_chain {
        notes.warning(format!("{kind}: fitted up to the end of the record, since there is no dynamic crush"));
    }
    let length_s = fitting.end_s();
    let compartment_alone = fitting.sensors.iter().all(|(mass, _)| mass + 1 == masses_kg.len());
    let scale = Scale {
        impact_speed_m_per_s: test.impact_speed_m_per_s,
        length_s,
        // Without a crush the spring of the nonlinear models has no last knot; the way at full speed stands for it.
        crush_m: test.dynamic_crush_m.unwrap_or(test.impact_speed_m_per_s * length_s),
        release: settings.release,
        compartment_alone,
    };
    let coordinates = Coordinates::of_search(kind, &masses_kg, settings.mass_fit, &scale);
    let Some(coordinates) = coordinates else { return Ok(Vec::new()) };
    let starts = (settings.fit_starts * coordinates.free.len()).div_ceil(STARTED_NUMBERS);
    let how = match task.method {
        Method::LShade => Search::LShade(settings.l_shade),
        _ => Search::Starts(starts, given_starts(task, &coordinates, &masses_kg, to_s)),
    };
    let Some(mut searched) = search(&coordinates, &fitting.observed, &how) else {
        notes.warning(format!("{kind}: {}", SolveError::NoFit { starts }));
        return Ok(Vec::new());
    };
    let mut remarks = Vec::new();
    if let Some(text) = &split {
        notes.info(format!("{kind}: {text}"));
        remarks.push(match settings.mass_fit {
            MassFit::Known => text.clone(),
            MassFit::Shares { lower, upper } => format!(
                "masses fitted: total {:.1} kg known, each but the last between {lower} and {upper} of what is left \
                 behind it",
                masses_kg.iter().sum::<f64>()
            ),
        });
    }
    remarks.append(&mut searched.remarks);
    for (wave, found) in fitting.observed.waves.iter_mut().zip(&searched.observed.waves) {
        wave.weight = found.weight;
    }
    let names: Vec<&str> = coordinates.free.iter().map(|number| kind.parameter_names()[number.index]).collect();
    let start = |minimum: &Optimum| {
        let on_bound = names.iter().zip(&minimum.on_bound).filter(|(_, on_bound)| **on_bound);
        let start = FitStart {
            model: coordinates.model(&minimum.theta)?,
            on_bound: on_bound.map(|(name, _)| *name).collect(),
            iterations: minimum.iterations,
            evaluations: searched.evaluations,
            within_search: is_chain,
        };
        Some((start, (minimum.cost / fitting.observed.rows() as f64).sqrt() * fitting.observed.scale_m()))
    };
    let from_dual = minimum_from_dual(&coordinates, &searched).filter(|_| !compartment_alone);
    let ends = Ends {
        starts: searched.minima.iter().filter_map(start).collect(),
        from_dual: from_dual.as_ref().and_then(start).map(|(start, _)| start),
        remarks: &remarks,
    };
    if kind == ModelKind::DoubleSpringMassDamper && compartment_alone {
        Ok(pairs(fitting, &ends, notes))
    } else {
        Ok(explanations(fitting, &ends, notes))
    }
}

/// Which sensors could tell how the mass of this model divides.
fn mass_evidence(task: &Task<'_>) -> MassEvidence {
    let count = mass_count(task.model);
    let mut masses = task.test.sensors.iter().filter_map(|sensor| sensor.place.mass(count));
    if masses.any(|mass| mass + 1 < count) { MassEvidence::SeveralMasses } else { MassEvidence::Compartment }
}

/// Where a descent from the dual of the best double model ends, if that is none of the minima of the search.
fn minimum_from_dual(coordinates: &Coordinates<Model>, searched: &Searched) -> Option<Optimum> {
    let Model::DoubleSpringMassDamper(best) = coordinates.model(&searched.minima.first()?.theta)? else { return None };
    let dual = coordinates.coordinates_of(&Model::DoubleSpringMassDamper(best.dual()));
    let problem = Problem::new(coordinates, &searched.observed, 0.0);
    let end = descend(&problem, &dual, &bounds(coordinates, 200, 1e-15))?;
    let apart = |m: &Optimum| m.theta.iter().zip(&end.theta).any(|(a, b)| (a - b).abs() > APART);
    searched.minima.iter().all(apart).then_some(end)
}

/// End of the window, s after time zero: that of the settings, else dynamic crush, for the elastoplastic model
/// rebound. `None`: the end of the record.
fn window_end(task: &Task<'_>) -> Option<f64> {
    let crush = task.test.time_of_dynamic_crush_s;
    task.settings.fit_to_s.or(match task.model {
        ModelKind::Elastoplastic => crush.and(task.test.time_of_rebound_s),
        _ => crush,
    })
}

/// Free numbers for which the starts of the settings are meant: those of a double model.
const STARTED_NUMBERS: usize = 4;
/// Springs and dampers elsewhere than at the soft place of [`one_soft_pair`], as multiples of those there.
const NEARLY_RIGID: f64 = 100.0;
/// Least damper of [`one_soft_pair`], in units of mass over time of crush: searches in logarithms cannot start at
/// zero.
const SOME_DAMPING: f64 = 0.01;

/// A chain that is nearly one mass: the Kelvin model of this crush and time at one place, with all masses behind it,
/// and nearly rigid elsewhere. A start of the search for chains: one for each place.
fn one_soft_pair(
    kind: ModelKind,
    masses_kg: &[f64],
    soft: usize,
    v0: f64,
    (time_s, crush_m): (f64, f64),
) -> Option<Model> {
    let behind_kg: f64 = masses_kg[soft..].iter().sum();
    let kelvin = kelvin_from_events(behind_kg, v0, time_s, crush_m).ok()?.model;
    let damper = kelvin.damping_n_s_per_m.max(SOME_DAMPING * behind_kg / time_s);
    let value = |index: usize, parameter: &Parameter| -> Option<f64> {
        let place = kind.parameters()[..index].iter().filter(|before| before.kind == parameter.kind).count();
        let rigid = if place == soft { 1.0 } else { NEARLY_RIGID };
        Some(match parameter.kind {
            ParameterKind::Mass => *masses_kg.get(place)?,
            ParameterKind::Stiffness => rigid * kelvin.stiffness_n_per_m,
            _ => rigid * damper,
        })
    };
    let named = kind.parameters().iter().enumerate().map(|(k, p)| Some((p.name.to_owned(), value(k, p)?)));
    Model::from_parameters(kind, &named.collect::<Option<_>>()?).ok()
}

/// Starts that other solvers give: closed forms of the events, and the fit of a nonlinear model to the displacement.
fn given_starts(
    task: &Task<'_>,
    coordinates: &Coordinates<Model>,
    masses_kg: &[f64],
    to_s: Option<f64>,
) -> Vec<Vec<f64>> {
    let e = task.test;
    let events = e.time_of_dynamic_crush_s.zip(e.dynamic_crush_m);
    let (v0, m) = (e.impact_speed_m_per_s, e.mass_kg);
    if let (ModelKind::DoubleSpringMassDamper | ModelKind::TripleSpringMassDamper, Some(crush)) = (task.model, events) {
        let places = 0..masses_kg.len();
        let models = places.filter_map(|soft| one_soft_pair(task.model, masses_kg, soft, v0, crush));
        return models.map(|model| coordinates.coordinates_of(&model)).collect();
    }
    let model = match (task.model, events, e.displacement) {
        (ModelKind::Kelvin, Some((t, c)), _) => kelvin_from_events(m, v0, t, c).ok().map(|s| Model::Kelvin(s.model)),
        (ModelKind::Elastoplastic, Some((_, c)), _) => {
            let restitution = e.coefficient_of_restitution.filter(|e| *e > 0.0).unwrap_or(0.2);
            elastoplastic_from_events(m, v0, c, restitution).ok().map(Model::Elastoplastic)
        }
        (ModelKind::Nonlinear1 | ModelKind::Nonlinear2, Some((t, c)), Some(displacement)) => {
            let options = SingleMassFitOptions {
                mass_kg: m,
                impact_speed_m_per_s: v0,
                crush_m: c,
                time_of_dynamic_crush_s: t,
                time_zero_s: e.time_zero_s,
                from_s: task.settings.fit_from_s,
                to_s,
                samples: task.settings.fit_samples,
            };
            if task.model == ModelKind::Nonlinear1 {
                fit_nonlinear1(displacement, &options, false).ok().map(|(model, _)| Model::Nonlinear1(model))
            } else {
                search_nonlinear2(displacement, &options).ok().map(|(model, _)| Model::Nonlinear2(model))
            }
        }
        _ => None,
    };
    model.iter().map(|model| coordinates.coordinates_of(model)).collect()
}

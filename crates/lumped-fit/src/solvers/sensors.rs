//! Any model fitted to acceleration, velocity or displacement of one or several sensors: its search, and the minima of
//! that fitted as measured, as explanations of the record and as pairs of dual double models.

use crumple_lumped::{DoubleSpringMassDamper, Model, ModelKind, Parameter, ParameterKind};
use crumple_numerics::estimation::minimise::levenberg_marquardt::{Optimum, descend};
use crumple_signal::{About, Notes, Weight, remarks};
use rayon::prelude::*;

use crate::candidate::{Candidate, Method, Minimum};
use crate::closed_form::{elastoplastic_from_events, kelvin_from_events};
use crate::coordinates::{Coordinates, MassFit, Scale};
use crate::error::SolveError;
use crate::fit::as_measured::{dual_of, exchanged, is_own_dual};
use crate::fit::problem::{Problem, SingleMassFitOptions};
use crate::fit::search::{APART, AS_GOOD, REPORTED, Search, Searched, bounds_of_search, search};
use crate::parameters::{MassEvidence, masses, triple_masses};
use crate::record::observation::RESOLUTION_M;
use crate::record::sensor::FitQuantity;
use crate::solvers::fitting::{FitStart, FitTask};
use crate::solvers::table::{NeverStops, NoFiniteResponse, Task, mass_count};

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
    let Some(mut fitting) = FitTask::of_sensors(task, to_s, notes)? else { return Ok(Vec::new()) };
    let is_chain = matches!(kind, ModelKind::DoubleSpringMassDamper | ModelKind::TripleSpringMassDamper);
    if to_s.is_none() && is_chain {
        notes.push(NeverStops { model: kind.to_string(), to_s: None, largest_m: None });
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
        notes.push(NoFiniteResponse { model: kind.to_string(), starts });
        return Ok(Vec::new());
    };
    let mut remarks = Vec::new();
    if let Some(text) = &split {
        notes.push(MassesTaken { model: Some(kind.to_string()), reason: text.clone() });
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
    let names = coordinates.names();
    let start = |minimum: &Optimum| {
        let on_bound = names.iter().zip(&minimum.on_bound).filter(|(_, on_bound)| **on_bound);
        let start = FitStart {
            model: coordinates.model(&minimum.theta)?,
            on_bound: on_bound.map(|(name, _)| name.clone()).collect(),
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
fn minimum_from_dual(coordinates: &Coordinates, searched: &Searched) -> Option<Optimum> {
    let Model::DoubleSpringMassDamper(best) = coordinates.model(&searched.minima.first()?.theta)? else { return None };
    let dual = coordinates.coordinates_of(&Model::DoubleSpringMassDamper(best.dual()));
    let problem = Problem::new(coordinates, &searched.observed, 0.0);
    let end = descend(&problem, &dual, &bounds_of_search(coordinates))?;
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
fn given_starts(task: &Task<'_>, coordinates: &Coordinates, masses_kg: &[f64], to_s: Option<f64>) -> Vec<Vec<f64>> {
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
                from_s: task.settings.fit_from_s,
                to_s,
                samples: task.settings.fit_samples,
            };
            if task.model == ModelKind::Nonlinear1 {
                options.fit_nonlinear1(displacement, false).ok().map(|(model, _)| Model::Nonlinear1(model))
            } else {
                options.search_nonlinear2(displacement).ok().map(|(model, _)| Model::Nonlinear2(model))
            }
        }
        _ => None,
    };
    model.iter().map(|model| coordinates.coordinates_of(model)).collect()
}

/// Error of a displacement integrated twice by the trapezoidal rule at 10 kHz, m: that of known records is at most
/// 1.3e-6 m. Minima of the motion itself whose errors differ by less are not told apart.
const DISPLACEMENT_RESOLUTION_M: f64 = 1.3e-6;
/// Two sets whose parameters all differ by less than this share are one.
const SAME: f64 = 1e-3;

/// Where the searches of a fit ended, least error first, and what every candidate has to say.
pub(super) struct Ends<'a> {
    /// The starts of the fit, each with its root mean square error on the motion itself, in the unit of the first wave.
    pub starts: Vec<(FitStart, f64)>,
    /// Where the search leads from the dual of the best double model, if that is none of them.
    pub from_dual: Option<FitStart>,
    /// Notes of every candidate.
    pub remarks: &'a [String],
}

impl Ends<'_> {
    /// Those as good as the best: within 1 %, and `resolution`.
    fn as_good(&self, resolution: f64) -> Vec<&FitStart> {
        let best = self.starts.first().map_or(0.0, |(_, error)| *error);
        let good = self.starts.iter().filter(|(_, error)| *error <= AS_GOOD * best + resolution);
        good.map(|(start, _)| start).collect()
    }
}

/// Every minimum as good as the best, at most three, fitted as measured with the weights of the first.
///
/// For the double model with a sensor on the chassis also the minimum that is found from the dual of the best: the
/// second sensor tells the two apart, and the notes say by how much.
pub(super) fn explanations(mut fitting: FitTask<'_>, ends: &Ends<'_>, notes: &mut Notes) -> Vec<Candidate> {
    let kind = fitting.task.model;
    let mut starts: Vec<FitStart> = ends.as_good(0.0).into_iter().cloned().collect();
    if starts.len() > 1 {
        notes.push(SeveralSets { model: kind.to_string(), sets: starts.len() });
        starts.truncate(REPORTED);
    }
    let Some(best) = starts.first().and_then(|start| fitting.weighed_minimum(start)) else { return Vec::new() };
    let others: Vec<Option<Minimum>> = starts[1..].par_iter().map(|start| fitting.minimum(start)).collect();
    let mut fits: Vec<(FitStart, Minimum, Vec<String>)> = Vec::new();
    for (start, minimum) in starts.iter().zip(std::iter::once(Some(best.clone())).chain(others)) {
        let Some(minimum) = minimum else { continue };
        if fits.iter().any(|(_, other, _)| near(&minimum.model, &other.model, SAME)) {
            notes.push(SameSet { model: kind.to_string() });
            continue;
        }
        fits.push((start.clone(), minimum, ends.remarks.to_vec()));
    }
    if let Model::DoubleSpringMassDamper(model) = &best.model {
        if let Some(misfit) = fitting.observed.misfit(&Model::DoubleSpringMassDamper(model.dual())) {
            let (dual_errors, errors) = (fitting.errors(&misfit), fitting.errors(&best.misfit_m));
            fits[0].2.push(dual_in_words(&dual_errors, &errors));
            notes.push(DualMisses { model: kind.to_string(), dual_errors, errors });
        }
        // Where the dual leads if it is followed: the second best explanation.
        let followed = ends.from_dual.as_ref().and_then(|start| Some((start, fitting.minimum(start)?)));
        let apart = |minimum: &Minimum| fits.iter().all(|(_, other, _)| !near(&minimum.model, &other.model, SAME));
        if let Some((start, followed)) = followed.filter(|(_, followed)| apart(followed)) {
            let text = format!(
                "followed from the dual of the first: weighted error {:.3} times that of the first, not equivalent",
                followed.rmse_m() / best.rmse_m().max(f64::MIN_POSITIVE)
            );
            fits.push((start.clone(), followed, [ends.remarks, &[text]].concat()));
        }
    }
    let numbered = fits.into_iter().zip(1..);
    numbered.map(|((start, minimum, remarks), k)| fitting.candidate(&start, minimum, k, &remarks)).collect()
}

/// The double model with sensors on the compartment alone: every minimum as good as the best, at most three, each with
/// its dual, which fits equally, the softer front spring first.
///
/// The two candidates of a pair are numbered `2 k + 1` and `2 k + 2` and name each other as equivalent. A model that
/// is its own dual is one candidate: front and rear can move against each other there without a change of the record
/// in first order.
pub(super) fn pairs(mut fitting: FitTask<'_>, ends: &Ends<'_>, notes: &mut Notes) -> Vec<Candidate> {
    let kind = fitting.task.model;
    notes.push(TwoDuals { model: kind.to_string() });
    let of_displacement = fitting.observed.waves[0].quantity == FitQuantity::Displacement;
    let starts = ends.as_good(if of_displacement { DISPLACEMENT_RESOLUTION_M } else { 0.0 });
    let starts = &starts[..starts.len().min(REPORTED)];
    let Some(best) = starts.first().and_then(|start| fitting.weighed_minimum(start)) else { return Vec::new() };
    let others: Vec<Option<Minimum>> = starts[1..].par_iter().map(|start| fitting.minimum(start)).collect();
    let all = starts.iter().zip(std::iter::once(Some(best)).chain(others));
    let mut fits: Vec<(&FitStart, Minimum)> = all.filter_map(|(start, minimum)| Some((*start, minimum?))).collect();
    fits.sort_by(|(_, a), (_, b)| a.rmse_m().total_cmp(&b.rmse_m()));
    let least = fits[0].1.rmse_m();
    let mut kept: Vec<(&FitStart, Minimum)> = Vec::new();
    for (start, minimum) in fits {
        let known = kept.iter().any(|(_, other)| same_pair(&minimum.model, &other.model));
        let resolution = match (of_displacement, fitting.observed.is_as_measured()) {
            (false, _) => 0.0,
            (true, true) => RESOLUTION_M,
            (true, false) => DISPLACEMENT_RESOLUTION_M,
        };
        if minimum.rmse_m() <= AS_GOOD * least + resolution && !known {
            kept.push((start, minimum));
        }
    }
    if kept.len() > 1 {
        notes.push(SeveralPairs { model: kind.to_string(), pairs: kept.len() });
    }
    let mut candidates = Vec::new();
    for (start, minimum) in kept {
        let index = candidates.len() + 1;
        let Model::DoubleSpringMassDamper(model) = minimum.model.clone() else { continue };
        if is_own_dual(&start.model) || is_own_dual(&minimum.model) {
            let text = "its own dual, listed once, counts twice: front and rear can move against each other without a \
                change of the record in first order";
            let remarks = [ends.remarks, &[text.to_owned()]].concat();
            candidates.push(fitting.candidate(start, minimum, index, &remarks));
            continue;
        }
        let on_bound = start.on_bound.iter().map(|name| exchanged(name).to_owned()).collect();
        let start_of_dual = FitStart { on_bound, ..start.clone() };
        let dual = dual_of(&minimum, &model.dual());
        let mut pair: Vec<(&FitStart, Minimum)> = vec![(start, minimum)];
        pair.extend(dual.map(|minimum| (&start_of_dual, minimum)));
        if let [(_, a), (_, b)] = &pair[..]
            && front_spring(&b.model) < front_spring(&a.model)
        {
            pair.reverse();
        }
        let is_pair = pair.len() == 2;
        for (k, (start, minimum)) in pair.into_iter().enumerate() {
            let candidate = fitting.candidate(start, minimum, index + k, ends.remarks);
            candidates.push(Candidate { equivalent_to: is_pair.then_some(index + 1 - k), ..candidate });
        }
    }
    candidates
}

/// The remark on how a double model and its dual miss the sensors.
fn dual_in_words(dual_errors: &str, errors: &str) -> String {
    format!(
        "the dual model moves the compartment alike, but not the chassis: it misses by {dual_errors}, this one by \
         {errors}; the second sensor decides, and the two are not equivalent"
    )
}

fn front_spring(model: &Model) -> f64 {
    model.parameters().get("k1_n_per_m").copied().unwrap_or(0.0)
}

/// Whether all parameters agree to this share.
fn near(a: &Model, b: &Model, share: f64) -> bool {
    let others = b.parameters();
    a.parameters()
        .iter()
        .all(|(name, value)| (value - others[name]).abs() <= share * value.abs().max(others[name].abs()))
}

/// Whether two double models, or one and the dual of the other, are one.
fn same_pair(a: &Model, b: &Model) -> bool {
    let dual = |model: &DoubleSpringMassDamper| Model::DoubleSpringMassDamper(model.dual());
    near(a, b, SAME) || matches!(a, Model::DoubleSpringMassDamper(a) if near(&dual(a), b, SAME))
}

remarks! {
    /// Remarks of fits to sensors.
    pub REMARKS;

    /// Masses of a model with several masses: given, or an assumed share of the whole.
    CR521 MassesTaken { model: Option<String>, reason: String }
    bears on (About::Model(String::new()), Weight::None)
    decided "m1, m2 or triple_masses state the masses. Where nobody does, front_mass_fraction is in front: 0.25, which \
             is an assumption."
    means "All springs and dampers of the model depend on these masses. Sensors of the compartment do not show them."
    remedy "nothing, or state m1 or front_mass_fraction where they are known"
    says match model {
        Some(model) => format!("{model}: {reason}"),
        None => reason.clone(),
    };

    /// Several sets of parameters follow the record as well as the best one.
    CR522 SeveralSets { model: String, sets: usize }
    bears on (About::Model(model.clone()), Weight::Slight)
    decided "The search ended at several sets of parameters with errors within 1 % of the least. Three of them at most \
             become candidates."
    means "The motion of the model holds where sensors are. Any of the sets may be the vehicle."
    remedy "quote none of its parameters; name sensors on further masses, or use a model with fewer parameters"
    says format!(
        "{model}: the parameters are not identifiable from this record: {sets} sets fit within 1 % of the best"
    );

    /// Two sets of parameters became one when they were fitted as measured.
    CR523 SameSet { model: String }
    bears on (About::Model(String::new()), Weight::None)
    decided "Every parameter differs by less than 0.1 % from an earlier set."
    means "The earlier candidate stands for both."
    remedy "nothing"
    says format!("{model}: a further set is left out, as measured it is the same as an earlier one");

    /// A sensor in front tells a double model from its dual.
    CR524 DualMisses { model: String, dual_errors: String, errors: String }
    bears on (About::Model(String::new()), Weight::None)
    decided "Each double model has a dual with the same motion of the compartment. Both are compared with all sensors."
    means "The dual is ruled out where its error is much larger than the error of the model."
    remedy "nothing"
    says format!("{model}: {}", dual_in_words(dual_errors, errors));

    /// Sensors of the compartment do not tell a double model from its dual.
    CR525 TwoDuals { model: String }
    bears on (About::Model(String::new()), Weight::None)
    decided "Each double model has a dual with the same motion of the compartment. Both are candidates, the one with \
             the softer front spring first."
    means "Motion and crush of both are the same. Springs and dampers differ."
    remedy "name a sensor on the front mass: sensors"
    says format!("{model}: two dual solutions move the compartment alike. A sensor on the front mass can decide");

    /// Several pairs of dual models follow the record as well as the best one.
    CR526 SeveralPairs { model: String, pairs: usize }
    bears on (About::Model(model.clone()), Weight::Slight)
    decided "Pairs count whose errors are within 1 % of the least. For a displacement 0.1 µm is added where the filter \
             of the record is known, else 1.3 µm: no displacement is more accurate."
    means "The motion of the compartment holds. Any of the pairs may be the vehicle."
    remedy "quote none of its parameters; name a sensor on the front mass, or use a model with fewer parameters"
    says format!(
        "{model}: the parameters are not identifiable: {pairs} pairs of sets fit equally well within the accuracy of \
         the record"
    );
}

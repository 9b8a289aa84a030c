//! Solvers without a search over the whole motion: closed forms, and curves extracted from measured motions.
//!
//! Kelvin and elastoplastic model from the crash events.
//!
//! Two events fix two parameters, so nothing is left over: a closed form has no residual and no error of its own. How
//! far it is from the fitted model is a matter of the assessment, which widens its intervals by that distance.

use crumple_lumped::{CrushedStructure, Elastoplastic, MOST_KNOTS, Model};
use crumple_signal::{About, Displacement, Note, Notes, Signal, Weight, remarks};

use crate::candidate::{Candidate, Minimum};
use crate::closed_form::{KelvinBranch, RIGID_RESTITUTION, elastoplastic_of_record, kelvin_from_events};
use crate::error::SolveError;
use crate::extraction::extract::extract;
use crate::extraction::problem::{AskedCurve, ExtractionTest, MeasuredElement, MeasuredMass};
use crate::parameters::free_parameters;
use crate::record::sensor::SensorPlace;
use crate::solvers::fitting::{FitStart, FitTask, NothingToFit, computed};
use crate::solvers::load_paths;
use crate::solvers::table::{Extent, NoFiniteResponse, Task, crush_of, extent_of, row_of};

/// Starts of the loading stiffness of a record that never stops, over `m (v0/C)²`.
const STIFFNESSES: [f64; 5] = [0.1, 0.3, 1.0, 2.0, 4.0];
/// An unloading stiffness that no record reaches, over the largest loading stiffness that is tried.
const BEYOND: f64 = 1e6;

/// A candidate that was computed and not fitted, with the minimum nearby, by which it is assessed: over the window of
/// the settings, up to dynamic crush, or to rebound where the unloading shows.
fn unfitted(task: &Task<'_>, model: Model, remark: String) -> Vec<Candidate> {
    let rebound_s = task.test.time_of_rebound_s.filter(|_| matches!(model, Model::Elastoplastic(_)));
    let to_s = task.settings.fit_to_s.or(rebound_s).or(task.test.time_of_dynamic_crush_s);
    // A record that is too coarse for a fit still has its closed form.
    let fitting = FitTask::of_pulse(task, to_s).ok().flatten();
    let minimum = fitting.and_then(|fitting| fitting.minimum(&FitStart::computed(model.clone())));
    vec![Candidate { minimum, ..computed(task, model, vec![Note::info(remark)]) }]
}

/// The Kelvin model with the time and the depth of dynamic crush and the impact speed of the test.
///
/// Which branch applies depends on the centroid time over the time of crush, `C/(v0 t_m)`: underdamped between `1/e`
/// and `2/π`, overdamped below. Above `2/π` no damping ratio exists, and the undamped model with the same crush is
/// given with a warning.
pub(crate) fn kelvin(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    let Some((t_m, crush)) = crush_of(task, notes) else { return Ok(Vec::new()) };
    let test = task.test;
    let solution = match kelvin_from_events(test.mass_kg, test.impact_speed_m_per_s, t_m, crush) {
        Ok(solution) => solution,
        Err(error) => {
            notes.push(NoClosedForm { model: task.model.to_string(), reason: error.to_string() });
            return Ok(Vec::new());
        }
    };
    let ratio = solution.time_ratio;
    let remark = match solution.branch {
        KelvinBranch::Underdamped => {
            format!("t_c/t_m = {ratio:.4}: damping ratio {:.4}", solution.damping_ratio)
        }
        KelvinBranch::Overdamped => format!(
            "t_c/t_m = {ratio:.4} is not above 1/e = 0.3679: overdamped, damping ratio {:.3}",
            solution.damping_ratio
        ),
        KelvinBranch::UndampedReduction { model_time_of_dynamic_crush_s: model_s } => {
            notes.push(UndampedKelvin { time_ratio: ratio, model_s, test_s: t_m });
            undamped_in_words(ratio, model_s, t_m)
        }
    };
    Ok(unfitted(task, Model::Kelvin(solution.model), remark))
}

/// The remark on a Kelvin model without a damper, which stops at another time than the test, s.
fn undamped_in_words(time_ratio: f64, model_s: f64, test_s: f64) -> String {
    format!(
        "t_c/t_m = {time_ratio:.4} is not below 2/pi = 0.6366: no damping ratio fits. The undamped model is used: same \
         crush and speed, but it stops at {:.2} ms instead of {:.2} ms",
        1e3 * model_s,
        1e3 * test_s
    )
}

/// The elastoplastic model with crush, speed and restitution of the test; where the record never stops, its loading
/// part, fitted.
///
/// A restitution of zero within its uncertainty leaves the unloading stiffness without a value: a stiff line stands
/// for it, and a warning says so. Without a known restitution there is no candidate.
pub(crate) fn elastoplastic(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    let Some(extent) = extent_of(task, notes) else { return Ok(Vec::new()) };
    if !extent.stops {
        return loading_part(task, &extent, notes);
    }
    let (t_m, crush) = (extent.time_s, extent.crush_m);
    let test = task.test;
    let restitution = match test.coefficient_of_restitution {
        Some(e) => e,
        None => {
            notes.push(NoRestitution {});
            return Ok(Vec::new());
        }
    };
    match elastoplastic_of_record(test.mass_kg, test.impact_speed_m_per_s, crush, restitution) {
        Ok((model, true)) => {
            notes.push(RigidUnloading { restitution });
            Ok(unfitted(task, Model::Elastoplastic(model), rigid_in_words(restitution)))
        }
        Ok((model, false)) => {
            let model_t_m = std::f64::consts::FRAC_PI_2 * crush / test.impact_speed_m_per_s;
            let remark = format!(
                "crush, speed and restitution {restitution:.4} are those of the test; it stops at {:.2} ms, the test \
                 at {:.2} ms",
                1e3 * model_t_m,
                1e3 * t_m
            );
            Ok(unfitted(task, Model::Elastoplastic(model), remark))
        }
        Err(error) => {
            notes.push(NoClosedForm { model: task.model.to_string(), reason: error.to_string() });
            Ok(Vec::new())
        }
    }
}

/// The remark on an unloading that is rigid within the uncertainty of the rebound.
fn rigid_in_words(restitution: f64) -> String {
    format!(
        "the rebound is zero within its uncertainty (restitution {restitution:.4}): the unloading is rigid, and its \
         stiffness not determined; {:.0} times the loading stiffness stands for it, of which the rebound is {:.0} % of \
         the impact speed",
        RIGID_RESTITUTION.powi(-2),
        100.0 * RIGID_RESTITUTION
    )
}

/// The loading part of the elastoplastic model, fitted to a displacement that never stops. No sample depends on the
/// unloading stiffness: it is set to the loading stiffness, the least that a structure can have, and named among the
/// active bounds.
fn loading_part(task: &Task<'_>, extent: &Extent, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    let Some(fitting) = FitTask::of_pulse(task, task.settings.fit_to_s)? else { return Ok(Vec::new()) };
    let (mass_kg, rate) = (task.test.mass_kg, task.test.impact_speed_m_per_s / extent.crush_m);
    let unit = mass_kg * rate * rate;
    let start = |times: &f64| FitStart {
        on_bound: vec!["unloading_stiffness_n_per_m".to_owned()],
        ..FitStart::computed(Model::Elastoplastic(Elastoplastic {
            mass_kg,
            loading_stiffness_n_per_m: times * unit,
            unloading_stiffness_n_per_m: BEYOND * unit,
            release: true,
        }))
    };
    let fits = STIFFNESSES.iter().map(start).filter_map(|start| fitting.minimum(&start).map(|found| (start, found)));
    let Some((start, mut minimum)) = fits.min_by(|(_, a), (_, b)| a.rmse_m().total_cmp(&b.rmse_m())) else {
        notes.push(NoFiniteResponse { model: task.model.to_string(), starts: STIFFNESSES.len() });
        return Ok(Vec::new());
    };
    if let Model::Elastoplastic(model) = &mut minimum.model {
        model.unloading_stiffness_n_per_m = model.loading_stiffness_n_per_m;
    }
    let remark = "only the loading is fitted: the record shows no unloading. The unloading stiffness is set to the \
    loading stiffness, its lowest value: do not use the rebound of this model";
    Ok(vec![fitting.candidate(&start, minimum, 1, &[remark.to_owned()])])
}

/// Rate factor of a vehicle's structure, s/m, where no test tells: mild steel columns of 60 to 100 mm between 40 and
/// 64 km/h have 0.006 to 0.012 by the law of Cowper and Symonds.
pub const RATE_PRIOR_S_PER_M: f64 = 0.008;
/// The same of one mass in place of a vehicle, over the speed of its compartment: less 0.004 s/m for the masses in
/// front of it. They are stopped before it, which takes energy that one mass does not have, and more of it at a higher
/// speed: cars of two masses on plastic structures without rate effect, a front mass of 15 to 35 %, look like one mass
/// whose force falls by 0.2 to 0.6 % for each m/s.
pub const ONE_MASS_RATE_S_PER_M: f64 = 0.004;
/// Restitution of a full frontal test near 56 km/h, where the record does not show the rebound: 0.1 to 0.2.
pub(crate) const USUAL_RESTITUTION: f64 = 0.15;
/// Restitution below which a record shows no rebound: the drift of a velocity, 2 % of 15 m/s.
const NO_REBOUND: f64 = 0.02;
/// Time between two knots, s: half a period of what CFC 60 passes of a wave, with as much again for noise.
pub(crate) const KNOT_SPACING_S: f64 = 0.009;

/// Least unloading stiffness over the steepest slope of the curve: below one, unloading would give back more than was
/// put in.
const STIFFER: f64 = 1.05;
/// The last piece of a curve, at least, over its largest deflection: beyond it the curve goes on with its slope.
const LAST_PIECE: f64 = 0.03;
/// The first knot, beside those equal in time, after this part of their spacing: structures reach their plateau in 1 to
/// 5 cm, which CFC 60 does not resolve in time, but its energy is in the record.
const FIRST_KNOT: usize = 3;
/// The first piece, at least.
const LEAST_PIECE: f64 = 1e-3;
/// Knots at least, beside that at zero.
const FEWEST_KNOTS: usize = 3;
/// Samples of the motion that a curve is read from: fewer say nothing of its knots, more nothing further.
const SAMPLES: std::ops::Range<usize> = 12..1000;

/// Displacement, velocity and acceleration from contact to the end of the loading.
struct Loading {
    dt_s: f64,
    displacement_m: Vec<f64>,
    velocity_m_per_s: Vec<f64>,
    acceleration_m_per_s2: Vec<f64>,
}

impl Loading {
    /// By differences of the displacement, which is a sum of sums: the second difference is a mean of neighbours of the
    /// acceleration. `None` with too few samples, or where the vehicle does not move towards the barrier.
    fn of(displacement: &Signal<Displacement>, to_s: f64) -> Option<Self> {
        let x = displacement.samples();
        let from = displacement.index_at_or_after(0.0);
        let to = displacement.index_at_or_after(to_s).min(x.len());
        let stride = (to.saturating_sub(from) / SAMPLES.end).max(1);
        let (first, last) = (from.max(stride), to.min(x.len().saturating_sub(stride)));
        let each = |of: &dyn Fn(usize) -> f64| (first..last).step_by(stride).map(of).collect::<Vec<f64>>();
        let dt_s = stride as f64 * displacement.dt_s();
        let loading = Self {
            dt_s,
            displacement_m: each(&|k| x[k]),
            velocity_m_per_s: each(&|k| (x[k + stride] - x[k - stride]) / (2.0 * dt_s)),
            acceleration_m_per_s2: each(&|k| (x[k + stride] - 2.0 * x[k] + x[k - stride]) / (dt_s * dt_s)),
        };
        let end = loading.displacement_m.last().copied().unwrap_or_default();
        (loading.displacement_m.len() >= SAMPLES.start && end > 0.0).then_some(loading)
    }

    /// Deflections of so many knots or fewer, equal in time and so closer where the mass is slower, which is where the
    /// record says more of the curve; the last at the largest deflection, the piece before it long enough that its
    /// slope may go on beyond.
    fn places(&self, knots: usize) -> Vec<f64> {
        let last = self.displacement_m.len() - 1;
        let end = self.displacement_m[last];
        let early = self.displacement_m[last / (knots * FIRST_KNOT)];
        let inner = std::iter::once(early).chain((1..knots).map(|j| self.displacement_m[last * j / knots]));
        let inner = inner.filter(|place| *place > LEAST_PIECE * end && *place < (1.0 - LAST_PIECE) * end);
        std::iter::once(0.0).chain(inner).chain([end]).collect()
    }
}

/// Curves with knots by the record: of one mass to the pulse's displacement alone, and where a sensor sits on the
/// engine, of two masses to both (`load_paths`). A force on the wall is fitted with them if it is among the sensors.
pub(crate) fn fit(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    let Some(extent) = extent_of(task, notes) else { return Ok(Vec::new()) };
    let to_s = task.settings.fit_to_s.or(extent.stops.then_some(extent.time_s));
    let wall = task.test.sensors.iter().any(|sensor| sensor.place == SensorPlace::Wall);
    let fitting = if wall { FitTask::of_sensors(task, to_s, notes)? } else { FitTask::of_pulse(task, to_s)? };
    let Some((displacement, mut fitting)) = task.test.displacement.zip(fitting) else {
        notes.push(NothingToFit::displacement(task.model));
        return Ok(Vec::new());
    };
    let loading = Loading::of(displacement, extent.time_s);
    let mut candidates = Vec::new();
    for knots in knot_counts(extent.time_s) {
        let minimum = loading.as_ref().and_then(|loading| curve(task, loading, knots, &extent, &mut fitting));
        let Some(minimum) = minimum else { continue };
        let remarks = remarks(task, &minimum.model);
        let start = FitStart::computed(minimum.model.clone());
        candidates.push(fitting.candidate(&start, minimum, candidates.len() + 1, &remarks));
    }
    if candidates.is_empty() {
        notes.push(NoCurve { model: task.model.to_string(), masses: 1 });
    }
    candidates.extend(load_paths::fit(task, &extent, candidates.len() + 1, notes)?);
    Ok(candidates)
}

/// How many knots are tried: as many as the record carries, two thirds and half of them. Which is for prediction
/// follows from the evidence, as between any two candidates.
fn knot_counts(to_s: f64) -> impl Iterator<Item = usize> {
    let most = ((to_s / KNOT_SPACING_S).round() as usize).clamp(FEWEST_KNOTS, MOST_KNOTS);
    let mut counts = vec![most, (2 * most).div_ceil(3), most.div_ceil(2)];
    counts.retain(|knots| *knots >= FEWEST_KNOTS);
    counts.dedup();
    counts.into_iter()
}

/// The curve with so many knots, read off the motion and fitted as measured.
fn curve(
    task: &Task<'_>,
    loading: &Loading,
    knots: usize,
    extent: &Extent,
    fitting: &mut FitTask<'_>,
) -> Option<Minimum> {
    let (mass_kg, v0) = (task.test.mass_kg, task.test.impact_speed_m_per_s);
    let knots_m = loading.places(knots);
    let mass = MeasuredMass {
        mass_kg: Some(mass_kg),
        displacement_m: loading.displacement_m.clone(),
        velocity_m_per_s: loading.velocity_m_per_s.clone(),
        acceleration_m_per_s2: loading.acceleration_m_per_s2.clone(),
        noise_n: 1.0,
    };
    let elements = vec![MeasuredElement { front: None, rear: 0, curve: 0, gap_m: 0.0 }];
    let test = ExtractionTest {
        dt_s: loading.dt_s,
        masses: vec![mass],
        elements,
        total_mass_kg: None,
        wall: None,
        through: None,
    };
    let asked = AskedCurve { knots_m: knots_m.clone(), rate_s_per_m: task.settings.rate_factor_s_per_m };
    let forces_n = extract(&[test], &[asked], 0.0)?.forces_n.swap_remove(0);
    let read: Vec<(f64, f64)> = knots_m.into_iter().zip(forces_n).skip(1).collect();
    let start = Model::ForceDeflection(structure(task, &read, extent)?);
    let free = free_parameters(&start, v0, extent.crush_m);
    fitting.weighed_nearby(&start, &free)
}

/// The restitution that a structure is to have: that of the test.
pub(super) fn restitution(task: &Task<'_>) -> f64 {
    task.test.coefficient_of_restitution.map_or(USUAL_RESTITUTION, |e| e.max(NO_REBOUND))
}

/// The structure with these knots: stiff enough in unloading that the restitution is that of the test.
fn structure(task: &Task<'_>, knots: &[(f64, f64)], extent: &Extent) -> Option<CrushedStructure> {
    let (mass_kg, v0) = (task.test.mass_kg, task.test.impact_speed_m_per_s);
    let restitution = restitution(task);
    let stiff = 1e3 * mass_kg * (v0 / extent.crush_m).powi(2) * knots.len() as f64;
    let rate = task.settings.rate_factor_s_per_m;
    let steep = CrushedStructure::new(mass_kg, knots, stiff, rate).ok()?;
    let at_turn = knots.last()?.1;
    let by_restitution = at_turn * at_turn / (mass_kg * (v0 * restitution).powi(2));
    let points = steep.knots();
    let slopes = points.windows(2).map(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0));
    let steepest = slopes.fold(0.0, f64::max);
    CrushedStructure::new(mass_kg, knots, by_restitution.max(STIFFER * steepest), rate).ok()
}

/// What was assumed.
fn remarks(task: &Task<'_>, model: &Model) -> Vec<String> {
    let knots = if let Model::ForceDeflection(structure) = model { structure.knots().len() - 1 } else { 0 };
    let unloading = if task.test.coefficient_of_restitution.is_some() {
        "of the test".to_owned()
    } else {
        format!("{USUAL_RESTITUTION}, the usual one of a full frontal test: the record shows none")
    };
    vec![
        format!("{knots} knots and the one at zero; the record supports one every 9 ms"),
        format!("unloading stiffness from the restitution {unloading}"),
        format!(
            "rate factor {} s/m is a prior, +- 0.005: {RATE_PRIOR_S_PER_M} s/m for a steel structure, less 0.004 for \
             the masses in front of the compartment. One test cannot identify it; tests with speeds a tenth apart can",
            task.settings.rate_factor_s_per_m
        ),
    ]
}

remarks! {
    /// Remarks of closed forms, and of curves read off motions.
    pub REMARKS;

    /// The formula of a model has no solution with the events of the test.
    CR511 NoClosedForm { model: String, reason: String }
    bears on (About::Model(model.clone()), Weight::Slight)
    decided "The formula refuses the events. The sentence has the value and what is expected of it."
    means "The model has no candidate from the events. Fits to the motion are not touched by it."
    remedy "check impact speed, time zero and unit of the pulse"
    says format!("{model}: not solved, {reason}");

    /// No damping ratio gives crush and time of the test: the Kelvin model is taken without a damper.
    CR512 UndampedKelvin { time_ratio: f64, model_s: f64, test_s: f64 }
    bears on (About::Model("kelvin".to_owned()), Weight::Slight)
    decided "t_c is the dynamic crush over the impact speed, t_m the time of dynamic crush. Without a damper t_c/t_m \
             is 2/pi = 0.6366, and every damper makes it less (Huang, Vehicle Crash Mechanics, 2002)."
    means "Model and test have one crush. The model stops later, and its pulse is longer."
    remedy "use the fit to the motion (direct-fit), or a force-deflection curve"
    says format!("kelvin: {}", undamped_in_words(*time_ratio, *model_s, *test_s));

    /// The elastoplastic model needs a restitution, and the events have none.
    CR513 NoRestitution {}
    bears on (About::Model("elastoplastic".to_owned()), Weight::Slight)
    decided "The unloading stiffness is the loading stiffness over the square of the coefficient of restitution."
    means "The model has no candidate from the events. Other models are not touched by it."
    remedy "give a record that goes on until the rebound, or use another model"
    says "elastoplastic: not solved, the coefficient of restitution is not known";

    /// The vehicle does not rebound within the uncertainty of the record: the unloading stiffness has no value.
    CR514 RigidUnloading { restitution: f64 }
    bears on (About::Model("elastoplastic".to_owned()), Weight::Slight)
    decided "A restitution up to 0.03 counts as none: the unloading then lasts 2 ms, of which CFC 60 shows half. So \
             does one whose interval holds zero. 1111 times the loading stiffness, a rebound of 3 %, then stands for \
             the unloading stiffness."
    means "Crush and loading stiffness hold. The unloading stiffness is no number of the vehicle; its interval is open."
    remedy "do not quote the unloading stiffness"
    says format!("elastoplastic: {}", rigid_in_words(*restitution));

    /// No force-deflection curve of one mass, or none of two masses, could be fitted.
    CR515 NoCurve { model: String, masses: usize }
    bears on (row_of(model), Weight::Slight)
    decided "Curves with few and with many knots are read off the motion by least squares, then fitted. None of them \
             had a solution. One mass needs 12 samples of the loading at least."
    means "There is no candidate of this model with so many masses. Other models are not touched by it."
    remedy "check sign and unit of the pulse and of the sensor on the engine, or use another model"
    says if *masses == 1 {
        format!("{model}: not fitted, no curve follows the displacement")
    } else {
        format!("{model}: no two masses, no curves follow both displacements")
    };
}

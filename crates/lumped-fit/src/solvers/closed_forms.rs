//! Kelvin and elastoplastic model from the crash events.
//!
//! Two events fix two parameters, so nothing is left over: a closed form has no residual and no error of its own. How
//! far it is from the fitted model is a matter of the assessment, which widens its intervals by that distance.

use crumple_lumped::{Elastoplastic, Model};
use crumple_signal::{Note, Notes};

use crate::closed_form::{RIGID_RESTITUTION, elastoplastic_of_record};
use crate::solvers::fitting::{FitStart, FitTask, computed};
use crate::solvers::table::{Extent, Task, crush_of, extent_of};
use crate::{Candidate, KelvinBranch, SolveError, kelvin_from_events};

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
            notes.warning(format!("kelvin: not solved, {error}"));
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
        KelvinBranch::UndampedReduction { model_time_of_dynamic_crush_s } => {
            let text = format!(
                "t_c/t_m = {ratio:.4} is not below 2/pi = 0.6366: no Kelvin damping ratio exists; reduced to the \
                 undamped model, which keeps crush and speed and stops at {:.2} ms instead of {:.2} ms",
                1e3 * model_time_of_dynamic_crush_s,
                1e3 * t_m
            );
            notes.warning(format!("kelvin: {text}"));
            text
        }
    };
    Ok(unfitted(task, Model::Kelvin(solution.model), remark))
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
            notes.warning("elastoplastic: not solved, the coefficient of restitution is not known");
            return Ok(Vec::new());
        }
    };
    match elastoplastic_of_record(test.mass_kg, test.impact_speed_m_per_s, crush, restitution) {
        Ok((model, true)) => {
            let remark = format!(
                "the rebound is zero within its uncertainty (restitution {restitution:.4}): the unloading is rigid, \
                 and its stiffness not determined; {:.0} times the loading stiffness stands for it, of which the \
                 rebound is {:.0} % of the impact speed",
                RIGID_RESTITUTION.powi(-2),
                100.0 * RIGID_RESTITUTION
            );
            notes.warning(format!("elastoplastic: {remark}"));
            Ok(unfitted(task, Model::Elastoplastic(model), remark))
        }
        Ok((model, false)) => {
            let model_t_m = std::f64::consts::FRAC_PI_2 * crush / test.impact_speed_m_per_s;
            let remark = format!(
                "keeps crush, speed and restitution {restitution:.4}; stops at {:.2} ms, the record at {:.2} ms",
                1e3 * model_t_m,
                1e3 * t_m
            );
            Ok(unfitted(task, Model::Elastoplastic(model), remark))
        }
        Err(error) => {
            notes.warning(format!("elastoplastic: not solved, {error}"));
            Ok(Vec::new())
        }
    }
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
        notes.warning(format!("{}: {}", task.model, SolveError::NoFit { starts: STIFFNESSES.len() }));
        return Ok(Vec::new());
    };
    if let Model::Elastoplastic(model) = &mut minimum.model {
        model.unloading_stiffness_n_per_m = model.loading_stiffness_n_per_m;
    }
    let remark = "the loading part only, fitted to the displacement: the record shows no unloading, so the unloading \
        stiffness is not determined and set to the loading stiffness, the least it can be";
    Ok(vec![fitting.candidate(&start, minimum, 1, &[remark.to_owned()])])
}

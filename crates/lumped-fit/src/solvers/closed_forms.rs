//! Kelvin and elastoplastic model from the crash events.
//!
//! Two events fix two parameters, so nothing is left over: a closed form has no residual and no error of its own. How
//! far it is from the fitted model is a matter of the assessment, which widens its intervals by that distance.

use crumple_lumped::Model;
use crumple_signal::Notes;

use super::extent::{crush_of, extent_of, unfitted};
use crate::closed_form::elastoplastic::{RIGID_RESTITUTION, elastoplastic_of_record};
use crate::fit::elastoplastic_fit::fit_elastoplastic_loading;
use crate::solvers::single_mass::fitted;
use crate::solvers::task::Task;
use crate::{Candidate, KelvinBranch, SolveError, kelvin_from_events};

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
    Ok(vec![unfitted(task, Model::Kelvin(solution.model), vec![remark])])
}

/// The elastoplastic model with crush, speed and restitution of the test; where the record never stops, its loading
/// part, fitted.
///
/// A restitution of zero within its uncertainty leaves the unloading stiffness without a value: a stiff line stands
/// for it, and a warning says so. Without a known restitution there is no candidate.
pub(crate) fn elastoplastic(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    let Some(extent) = extent_of(task, notes) else { return Ok(Vec::new()) };
    if !extent.stops {
        return fitted(task, &extent, notes, |x, options, remarks| {
            remarks.push(
                "the loading part only, fitted to the displacement: the record shows no unloading, so the unloading \
                 stiffness is not determined and set to the loading stiffness, the least it can be"
                    .to_owned(),
            );
            let (model, fit, deviations) = fit_elastoplastic_loading(x, options)?;
            Ok((Model::Elastoplastic(model), fit, deviations))
        });
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
            Ok(vec![unfitted(task, Model::Elastoplastic(model), vec![remark])])
        }
        Ok((model, false)) => {
            let model_t_m = std::f64::consts::FRAC_PI_2 * crush / test.impact_speed_m_per_s;
            let remark = format!(
                "keeps crush, speed and restitution {restitution:.4}; stops at {:.2} ms, the record at {:.2} ms",
                1e3 * model_t_m,
                1e3 * t_m
            );
            Ok(vec![unfitted(task, Model::Elastoplastic(model), vec![remark])])
        }
        Err(error) => {
            notes.warning(format!("elastoplastic: not solved, {error}"));
            Ok(Vec::new())
        }
    }
}

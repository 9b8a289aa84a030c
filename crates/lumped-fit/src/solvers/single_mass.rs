//! One mass fitted to its displacement: the Maxwell and the nonlinear models.

use crumple_lumped::Model;
use crumple_signal::{Displacement, Notes, Signal};

use super::extent::{Extent, crush_of, extent_of};
use crate::candidate::note::{CandidateNote, infos};
use crate::fit::maxwell_fit::undetermined_by_the_record;
use crate::fit::options::SingleMassFitOptions;
use crate::solvers::sensors;
use crate::solvers::task::Task;
use crate::{
    Candidate, Fit, SolveError, Uncertainty, bounds_remark, conditions_at_crush, firefly_nonlinear2, fit_maxwell,
    fit_nonlinear1, fit_nonlinear2, interior_point_nonlinear1,
};

/// A fitted model with the record of its fit and, where they exist, linearised deviations.
type SingleMassFit = (Model, Fit, Option<Uncertainty>);
/// Such a fit, or why there is none.
type FitResult = Result<SingleMassFit, SolveError>;

/// The Maxwell model fitted to the displacement; with other sensors or quantities the fit to sensors. A spring or
/// damper that is nearly rigid is reported as not determined.
pub(crate) fn maxwell(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    if !task.fits_displacement_alone() {
        return sensors::fit(task, notes);
    }
    let Some(extent) = extent_of(task, notes) else { return Ok(Vec::new()) };
    fitted(task, &extent, notes, |x, options, _| {
        let (model, fit, deviations) = fit_maxwell(x, options)?;
        Ok((Model::Maxwell(model), fit, deviations))
    })
}

/// The first nonlinear model under its side constraints. A fit that cannot meet the conditions at dynamic crush to
/// 1e-6 says by how much.
pub(crate) fn nonlinear1(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    if !task.fits_displacement_alone() {
        return sensors::fit(task, notes);
    }
    let Some(extent) = extent_of(task, notes) else { return Ok(Vec::new()) };
    let mut missed = None;
    let candidates = fitted(task, &extent, notes, |x, options, remarks| {
        remarks.push(if extent.stops {
            "constrained to the dynamic crush and its time; k1 <= k2, c1 >= c2 >= c3".to_owned()
        } else {
            "k1 <= k2, c1 >= c2 >= c3; the conditions at dynamic crush are left out, since the record has none"
                .to_owned()
        });
        let (model, fit) = fit_nonlinear1(x, options, extent.stops)?;
        if let Some([crush, speed]) = conditions_at_crush(&model, options).filter(|left| extent.stops && !met(left)) {
            missed = Some(format!(
                "the conditions at dynamic crush are not met: crush {:.3} % off, speed {:.3} % of that at impact left",
                100.0 * crush,
                100.0 * speed
            ));
            remarks.extend(missed.clone());
        }
        Ok((Model::Nonlinear1(model), fit, None))
    });
    if let Some(missed) = missed {
        notes.warning(format!("{}: {missed}", task.model));
    }
    candidates
}

/// Whether the relative conditions on crush and speed are met to 1e-6.
fn met(left: &[f64; 2]) -> bool {
    left.iter().all(|condition| condition.abs() <= 1e-6)
}

/// The first nonlinear model by the interior point of the paper. Needs a dynamic crush, to which its conditions
/// refer.
pub(crate) fn interior_point(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    // Its conditions are those at dynamic crush.
    let Some((time_s, crush_m)) = crush_of(task, notes) else { return Ok(Vec::new()) };
    fitted(task, &Extent { crush_m, time_s, stops: true }, notes, |x, options, remarks| {
        remarks.push(
            "the paper's way: interior point with x(t_m) = C, v(t_m) = 0, k1 <= k2, c1 >= c2 >= c3; direct-fit reaches \
             the same point"
                .to_owned(),
        );
        let (model, fit) = interior_point_nonlinear1(x, options)?;
        Ok((Model::Nonlinear1(model), fit, None))
    })
}

/// The second nonlinear model fitted to the displacement; with other sensors or quantities the fit to sensors.
pub(crate) fn nonlinear2(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    if !task.fits_displacement_alone() {
        return sensors::fit(task, notes);
    }
    let Some(extent) = extent_of(task, notes) else { return Ok(Vec::new()) };
    fitted(task, &extent, notes, |x, options, _| {
        let (model, fit, deviations) = fit_nonlinear2(x, options)?;
        Ok((Model::Nonlinear2(model), fit, deviations))
    })
}

/// The second nonlinear model by the firefly search of the paper.
pub(crate) fn firefly(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    let Some(extent) = extent_of(task, notes) else { return Ok(Vec::new()) };
    fitted(task, &extent, notes, |x, options, remarks| {
        let best = firefly_nonlinear2(x, options, &task.settings.firefly)?;
        remarks.push(if best.attraction > 0.0 {
            format!("mean attraction of two fireflies at the start {:.3}", best.attraction)
        } else {
            "the attraction of two fireflies is zero in these units: a random walk".to_owned()
        });
        Ok((Model::Nonlinear2(best.model), best.fit, None))
    })
}

/// Window, notes and candidate that all fits to the displacement of one mass have in common; `fit` makes the model.
///
/// The window ends with the settings, else with dynamic crush, else with the record. A fit without any finite
/// response is a warning and no candidate; other errors are passed on.
pub(super) fn fitted(
    task: &Task<'_>,
    extent: &Extent,
    notes: &mut Notes,
    fit: impl FnOnce(&Signal<Displacement>, &SingleMassFitOptions, &mut Vec<String>) -> FitResult,
) -> Result<Vec<Candidate>, SolveError> {
    let (kind, test, settings) = (task.model, task.test, task.settings);
    let Some(displacement) = test.displacement else {
        notes.warning(format!("{kind}: not fitted, there is no displacement"));
        return Ok(Vec::new());
    };
    let options = SingleMassFitOptions {
        mass_kg: test.mass_kg,
        impact_speed_m_per_s: test.impact_speed_m_per_s,
        crush_m: extent.crush_m,
        time_of_dynamic_crush_s: extent.time_s,
        time_zero_s: test.time_zero_s,
        from_s: settings.fit_from_s,
        to_s: settings.fit_to_s.or(extent.stops.then_some(extent.time_s)),
        samples: settings.fit_samples,
    };
    let mut remarks = Vec::new();
    let (model, fit, uncertainty) = match fit(displacement, &options, &mut remarks) {
        Ok(fitted) => fitted,
        Err(error @ SolveError::NoFit { .. }) => {
            notes.warning(format!("{kind}: {error}"));
            return Ok(Vec::new());
        }
        Err(error) => return Err(error),
    };
    remarks.insert(0, format!("fitted from {:.2} ms to {:.2} ms after time zero", 1e3 * fit.from_s, 1e3 * fit.to_s));
    if let Model::Maxwell(maxwell) = &model
        && let Some(finding) = undetermined_by_the_record(maxwell, test.impact_speed_m_per_s, extent.crush_m)
    {
        notes.warning(format!("{kind}: {finding}"));
        remarks.push(finding);
    }
    let mut notes = infos(remarks);
    notes.extend(bounds_remark(&model, &fit.active_bounds).map(CandidateNote::active_bounds));
    Ok(vec![Candidate {
        model,
        method: task.method,
        index: 1,
        equivalent_to: None,
        fit: Some(fit),
        uncertainty,
        notes,
    }])
}

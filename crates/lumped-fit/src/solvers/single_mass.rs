//! One mass fitted to its displacement: the Maxwell and the nonlinear models.

use crumple_lumped::{Maxwell, Model};
use crumple_signal::{About, Displacement, Note, Notes, Signal, Weight, remarks};

use crate::candidate::{Candidate, Fit, Minimum, bounds_remark};
use crate::error::SolveError;
use crate::fit::problem::SingleMassFitOptions;
use crate::solvers::fitting::{FitStart, FitTask, NothingToFit, computed, window_note};
use crate::solvers::sensors;
use crate::solvers::table::{Extent, NoFiniteResponse, Task, crush_of, extent_of};

/// A model with the record of how it was found on the motion itself, or why there is none.
type OnTheMotion = Result<(Model, Fit), SolveError>;

/// The Maxwell model. A spring or damper that is nearly rigid is reported as not determined.
pub(crate) fn maxwell(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    if !task.fits_displacement_alone() {
        return sensors::fit(task, notes);
    }
    let Some(extent) = extent_of(task, notes) else { return Ok(Vec::new()) };
    let mut candidates = sensors::fit(task, notes)?;
    for candidate in &mut candidates {
        if let Model::Maxwell(maxwell) = &candidate.model
            && let Some((part, gives_m)) =
                undetermined_by_the_record(maxwell, task.test.impact_speed_m_per_s, extent.crush_m)
        {
            let (model, crush_m) = (task.model.to_string(), extent.crush_m);
            candidate.notes.push(Note::info(rigid_in_words(part, gives_m, crush_m)));
            notes.push(NearlyRigid { model, part: part.to_owned(), gives_m, crush_m });
        }
    }
    Ok(candidates)
}

/// The first nonlinear model under its side constraints: the minimum as measured where that meets them, else the fit
/// that is held to them. Where that cannot meet the conditions at dynamic crush to 1e-6 it says by how much.
pub(crate) fn nonlinear1(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    if !task.fits_displacement_alone() {
        return sensors::fit(task, notes);
    }
    let Some(extent) = extent_of(task, notes) else { return Ok(Vec::new()) };
    let mut missed = None;
    let candidates = fitted(task, &extent, notes, |x, options, remarks| {
        remarks.push(if extent.stops {
            "constraints: dynamic crush and its time, k1 <= k2, c1 >= c2 >= c3".to_owned()
        } else {
            "k1 <= k2, c1 >= c2 >= c3; the conditions at dynamic crush are left out, since the record has none"
                .to_owned()
        });
        let (model, fit) = options.fit_nonlinear1(x, extent.stops)?;
        if let Some([crush, speed]) = options.conditions_at_crush(&model).filter(|left| extent.stops && !met(left)) {
            missed = Some((crush, speed));
            remarks.push(missed_in_words(crush, speed));
        }
        Ok((Model::Nonlinear1(model), fit))
    });
    if let Some((crush_off, speed_left)) = missed {
        notes.push(ConditionsNotMet { model: task.model.to_string(), crush_off, speed_left });
    }
    candidates
}

/// The remark on conditions that are missed, by shares of crush and impact speed.
fn missed_in_words(crush_off: f64, speed_left: f64) -> String {
    format!(
        "the conditions at dynamic crush are not met: crush {:.3} % off, speed {:.3} % of that at impact left",
        100.0 * crush_off,
        100.0 * speed_left
    )
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
    as_printed(task, &Extent { crush_m, time_s, stops: true }, notes, |x, options, remarks| {
        remarks.push(
            "the paper's way: interior point with x(t_m) = C, v(t_m) = 0, k1 <= k2, c1 >= c2 >= c3; direct-fit reaches \
             the same point"
                .to_owned(),
        );
        let (model, fit) = options.interior_point_nonlinear1(x)?;
        Ok((Model::Nonlinear1(model), fit))
    })
}

/// The second nonlinear model fitted to the displacement; with other sensors or quantities the fit to sensors.
pub(crate) fn nonlinear2(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    if !task.fits_displacement_alone() {
        return sensors::fit(task, notes);
    }
    let Some(extent) = extent_of(task, notes) else { return Ok(Vec::new()) };
    fitted(task, &extent, notes, |x, options, _| {
        let (model, fit) = options.search_nonlinear2(x)?;
        Ok((Model::Nonlinear2(model), fit))
    })
}

/// The second nonlinear model by the firefly search of the paper.
pub(crate) fn firefly(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    let Some(extent) = extent_of(task, notes) else { return Ok(Vec::new()) };
    as_printed(task, &extent, notes, |x, options, remarks| {
        let best = options.firefly_nonlinear2(x, &task.settings.firefly)?;
        remarks.push(if best.attraction > 0.0 {
            format!("mean attraction of two fireflies at the start {:.3}", best.attraction)
        } else {
            "the attraction of two fireflies is zero in these units: a random walk".to_owned()
        });
        Ok((Model::Nonlinear2(best.model), best.fit))
    })
}

/// A model found on the motion itself, then fitted as measured. A first nonlinear model whose minimum misses the side
/// conditions keeps the values that meet them.
fn fitted(
    task: &Task<'_>,
    extent: &Extent,
    notes: &mut Notes,
    find: impl FnOnce(&Signal<Displacement>, &SingleMassFitOptions, &mut Vec<String>) -> OnTheMotion,
) -> Result<Vec<Candidate>, SolveError> {
    let Some((fitting, start, remarks)) = start_of(task, extent, notes, find)? else { return Ok(Vec::new()) };
    let (model, fit) = start;
    let start = FitStart {
        on_bound: fit.active_bounds.clone(),
        iterations: fit.iterations,
        evaluations: fit.evaluations,
        ..FitStart::computed(model.clone())
    };
    let meets_conditions = |minimum: &Minimum| match &minimum.model {
        Model::Nonlinear1(model) => fitting.meets_conditions(model),
        _ => true,
    };
    Ok(vec![match fitting.minimum(&start) {
        Some(minimum) if meets_conditions(&minimum) => fitting.candidate(&start, minimum, 1, &remarks),
        nearby => printed(&fitting, model, fit, remarks, nearby),
    }])
}

/// A model as a paper's method finds it on the motion itself, with the minimum nearby, by which it is assessed.
fn as_printed(
    task: &Task<'_>,
    extent: &Extent,
    notes: &mut Notes,
    find: impl FnOnce(&Signal<Displacement>, &SingleMassFitOptions, &mut Vec<String>) -> OnTheMotion,
) -> Result<Vec<Candidate>, SolveError> {
    let Some((fitting, (model, fit), remarks)) = start_of(task, extent, notes, find)? else { return Ok(Vec::new()) };
    let start = FitStart { on_bound: fit.active_bounds.clone(), ..FitStart::computed(model.clone()) };
    let nearby = fitting.minimum(&start);
    Ok(vec![printed(&fitting, model, fit, remarks, nearby)])
}

/// The model as it was found, with the minimum nearby.
fn printed(fitting: &FitTask<'_>, model: Model, fit: Fit, remarks: Vec<String>, minimum: Option<Minimum>) -> Candidate {
    let mut notes: Vec<Note> = remarks.into_iter().map(Note::info).collect();
    notes.push(window_note(&fit));
    notes.extend(bounds_remark(&model, &fit.active_bounds).map(Note::info));
    Candidate { fit: Some(fit), minimum, ..computed(fitting.task, model, notes) }
}

/// What was found on the motion itself, with its remarks, and the displacement as measured.
type StartAsMeasured<'a> = (FitTask<'a>, (Model, Fit), Vec<String>);

/// The displacement as measured, what `find` finds on the motion itself, and its remarks.
///
/// The window ends with the settings, else with dynamic crush, else with the record. No finite response is a warning
/// and no candidate; other errors are passed on.
fn start_of<'a>(
    task: &'a Task<'a>,
    extent: &Extent,
    notes: &mut Notes,
    find: impl FnOnce(&Signal<Displacement>, &SingleMassFitOptions, &mut Vec<String>) -> OnTheMotion,
) -> Result<Option<StartAsMeasured<'a>>, SolveError> {
    let (kind, test, settings) = (task.model, task.test, task.settings);
    let to_s = settings.fit_to_s.or(extent.stops.then_some(extent.time_s));
    let Some((displacement, fitting)) = test.displacement.zip(FitTask::of_pulse(task, to_s)?) else {
        notes.push(NothingToFit::displacement(kind));
        return Ok(None);
    };
    let options = SingleMassFitOptions {
        mass_kg: test.mass_kg,
        impact_speed_m_per_s: test.impact_speed_m_per_s,
        crush_m: extent.crush_m,
        time_of_dynamic_crush_s: extent.time_s,
        from_s: settings.fit_from_s,
        to_s,
        samples: settings.fit_samples,
    };
    let mut remarks = Vec::new();
    match find(displacement, &options, &mut remarks) {
        Ok(found) => Ok(Some((fitting, found, remarks))),
        Err(SolveError::NoFit { starts }) => {
            notes.push(NoFiniteResponse { model: kind.to_string(), starts });
            Ok(None)
        }
        Err(error) => Err(error),
    }
}

/// Share of the dynamic crush below which a part of the model is nearly rigid.
const RIGID: f64 = 0.02;

/// A part of the Maxwell model, and how much it gives, m.
type Part = (&'static str, f64);

const DAMPER: &str = "damper";

/// Which part's parameter the record hardly determines, and what that part gives, m; `None` where both take part.
///
/// Spring and damper in series share the crush. The damper gives `m v0/c` until the mass stops, at most; the spring
/// gives the largest force over its stiffness, at a thousand instants up to twice the time `C/v0` (the force of a stiff
/// spring is largest soon after contact and falls slowly). Where one of them gives less than 2 % of the crush it could
/// as well be rigid: its value follows from that small part, to which noise, filter and the other's law contribute as
/// much.
pub(super) fn undetermined_by_the_record(model: &Maxwell, impact_speed_m_per_s: f64, crush_m: f64) -> Option<Part> {
    let damper = model.mass_kg * impact_speed_m_per_s / model.damping_n_s_per_m;
    let step_s = 2.0 * crush_m / impact_speed_m_per_s / 1000.0;
    let force =
        |k: u32| model.mass_kg * model.state(impact_speed_m_per_s, f64::from(k) * step_s).acceleration_m_per_s2.abs();
    let spring = (1..=1000).map(force).fold(0.0, f64::max) / model.stiffness_n_per_m;
    let is_rigid = |(_, gives_m): &Part| *gives_m < RIGID * crush_m;
    [(DAMPER, damper), ("spring", spring)].into_iter().find(is_rigid)
}

/// The remark on a part that is nearly rigid.
fn rigid_in_words(part: &str, gives_m: f64, crush_m: f64) -> String {
    let share = format!("{:.2} mm of {:.1} mm", 1e3 * gives_m, 1e3 * crush_m);
    if part == DAMPER {
        format!(
            "the damper is nearly rigid, it gives {share}: the record shows only that its damping is large. The model \
             is a spring"
        )
    } else {
        format!(
            "the spring is nearly rigid, it gives {share}: the record does not determine its stiffness, only that it \
             is large, and the model is a damper alone"
        )
    }
}

remarks! {
    /// Remarks of models of one mass.
    pub REMARKS;

    /// Spring or damper of the Maxwell model is so stiff that the record does not show it.
    CR527 NearlyRigid { model: String, part: String, gives_m: f64, crush_m: f64 }
    bears on (About::Model(model.clone()), Weight::Slight)
    decided "The part gives less than 2 % of the crush. A damper gives m v0/c, a spring its largest force over its \
             stiffness."
    means "Motion and crush of the model hold. Noise and filter decide the parameter of the rigid part as much as the \
           vehicle does."
    remedy "do not quote that parameter: say that it is large"
    says format!("{model}: {}", rigid_in_words(part, *gives_m, *crush_m));

    /// The first nonlinear model does not stop at crush and time of the test.
    CR528 ConditionsNotMet { model: String, crush_off: f64, speed_left: f64 }
    bears on (About::Model(model.clone()), Weight::Slight)
    decided "The single-mass paper asks for x(t_m) = C and v(t_m) = 0. More than 1e-6 of the crush or of the impact \
             speed is left."
    means "With k1 <= k2 and c1 >= c2 >= c3 no set was found on the motion that meets both. The candidate starts from \
           a set that misses the test by as much."
    remedy "check impact speed and time zero, or use the second nonlinear model"
    says format!("{model}: {}", missed_in_words(*crush_off, *speed_left));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_nearly_rigid_damper_is_found_and_a_working_one_is_not() {
        let model = Maxwell { mass_kg: 900.0, stiffness_n_per_m: 3e5, damping_n_s_per_m: 1e8 };
        let crush = model.events(10.0).dynamic_crush_m.unwrap();
        let (part, gives_m) = undetermined_by_the_record(&model, 10.0, crush).unwrap();
        let finding = rigid_in_words(part, gives_m, crush);
        assert!(finding.contains("shows only that its damping is large"), "{finding}");
        let working = Maxwell { damping_n_s_per_m: 4e4, stiffness_n_per_m: 1e6, ..model };
        let crush = working.events(10.0).dynamic_crush_m.unwrap();
        assert_eq!(undetermined_by_the_record(&working, 10.0, crush), None);
    }

    #[test]
    fn a_spring_that_has_relaxed_when_the_mass_stops_is_not_rigid() {
        // Nearly critical: hardly any force is left at dynamic crush, but the spring gave a fifth of the crush on the
        // way.
        let slow = Maxwell { mass_kg: 1600.0, stiffness_n_per_m: 6e5, damping_n_s_per_m: 1.6e4 };
        let crush = slow.events(17.0).dynamic_crush_m.unwrap();
        assert!(crush - 1600.0 * 17.0 / 1.6e4 < 0.02 * crush);
        assert_eq!(undetermined_by_the_record(&slow, 17.0, crush), None);
        // A spring hundred times as stiff is rigid beside the same damper: it gives c v0/k at most.
        let stiff = Maxwell { stiffness_n_per_m: 6e7, ..slow };
        let (part, gives_m) = undetermined_by_the_record(&stiff, 17.0, 1.7).unwrap();
        let finding = rigid_in_words(part, gives_m, 1.7);
        assert!(finding.contains("the spring is nearly rigid, it gives 4."), "{finding}");
    }
}

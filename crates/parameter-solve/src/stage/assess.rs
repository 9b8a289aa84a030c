//! How well each candidate's parameters are known, by the minimum of the misfit that it carries.

use crumple_lumped::{Model, ParameterKind};
use crumple_lumped_fit::{
    Assessed, AssessmentOptions, Candidate, FollowedEvents, MassFit, Method, Minimum, Observation, Propagation,
    propagate,
};
use crumple_numerics::estimation::work::determined;
use crumple_signal::{About, Weight, remarks};
use crumple_stage::Output;
use crumple_stage::records::EventsV1;
use rayon::prelude::*;

use crate::stage::inputs::Record;
use crate::stage::settings::{AssessmentSettings, StageSettings};

// Says of every candidate how well its parameters are known.

/// Shift of time zero from which a fit under side conditions may have its least misfit in another minimum.
const ONE_MINIMUM_S: f64 = 2.5e-4;

/// What a profile of all parameters may cost, in fits.
const FITS_OF_A_PROFILE: usize = 20;

/// What all candidates share.
struct Assessor<'a> {
    settings: &'a StageSettings,
    events: &'a EventsV1,
    /// Displacement from contact to its end, every sample: where events are read from.
    whole: Option<Observation>,
    mass_kg: f64,
    crush_m: f64,
}

/// Assesses all candidates that carry a minimum.
pub fn assess_all(
    candidates: &mut [Candidate],
    settings: &StageSettings,
    record: &Record,
    events: &EventsV1,
    out: &mut Output,
) -> anyhow::Result<()> {
    let (Some((displacement, measurement)), Some(crush_m)) = (&record.displacement, record.crush_m(events)) else {
        return Ok(());
    };
    if events.dynamic_crush_m.is_none() {
        out.notes().push(AssessedOverTheWindow {});
    }
    settings.assessment.check(Some(record.mass_kg), record.impact_speed_m_per_s)?;
    let end = (0.0, displacement.end_s());
    let speed = record.impact_speed_m_per_s;
    let whole = Observation::new(displacement, *measurement, speed, end, usize::MAX).ok();
    if measurement.is_exact() {
        out.notes().push(FilterNotKnown {});
    }
    let scene = Assessor { settings, events, whole, mass_kg: record.mass_kg, crush_m };
    assess_each(candidates, &settings.assessment, out, |candidate| scene.assess(candidate));
    scene.note_what_is_left_out(candidates, out);
    Ok(())
}

/// Assesses every candidate by itself. One that takes too much work, or whose assessment fails, stays without, for a
/// reason that the notes say.
pub fn assess_each(
    candidates: &mut [Candidate],
    asked: &AssessmentSettings,
    out: &mut Output,
    assess: impl Fn(&Candidate) -> Option<Assessed> + Sync,
) {
    let fits = 1 + asked.bootstrap + if asked.profile { FITS_OF_A_PROFILE } else { 0 };
    let fits = fits + if asked.inputs.any() { asked.repetitions } else { 0 };
    let assessed: Vec<_> = candidates
        .par_iter_mut()
        .map(|candidate| {
            candidate.minimum.iter_mut().for_each(|minimum| minimum.limit_work(fits));
            let assessed = determined(|| assess(candidate));
            candidate.minimum.iter_mut().for_each(Minimum::release_work);
            assessed
        })
        .collect();
    for (candidate, assessed) in candidates.iter_mut().zip(assessed) {
        candidate.assessed = assessed.unwrap_or_else(|reason| {
            out.notes().push(NotAssessed { id: candidate.id(), reason: reason.to_string() });
            None
        });
    }
}

/// How well the parameters of a fit that ended at its minimum are known, a stated chain's or that of several tests: the
/// covariance, what was asked beyond it, and for a chain of this mass, kg, uncertain inputs. The evidence for it is
/// taken at that minimum.
pub fn assess_fit(candidate: &Candidate, asked: &AssessmentSettings, mass_kg: Option<f64>) -> Option<Assessed> {
    let minimum = candidate.minimum.as_ref()?;
    let uncertain = minimum.with_inputs(&asked.of_intervals);
    let mut assessment = uncertain.assess((&minimum.model, true), asked.options())?;
    assessment.least_misfit = None;
    assessment.hold(&minimum.model);
    let mass_kg = mass_kg.filter(|_| candidate.stated.is_some() && asked.inputs.any());
    let propagation = mass_kg.and_then(|kg| minimum.propagate_chain(kg, &asked.inputs, asked.repetitions));
    Some(Assessed { assessment, propagation, repeated: "fit", front_mass_uncertainty: 0.0 })
}

impl Assessor<'_> {
    fn assess(&self, candidate: &Candidate) -> Option<Assessed> {
        let minimum = candidate.minimum.as_ref()?;
        let asked = &self.settings.assessment;
        let at_minimum = candidate.is_at_minimum();
        let options = if at_minimum { asked.options() } else { AssessmentOptions::default() };
        let uncertain = minimum.with_inputs(&asked.of_intervals);
        let values = if at_minimum { &minimum.model } else { &candidate.model };
        let mut assessment = uncertain.assess((values, at_minimum), options)?;
        assessment.interval.extend(candidate.fixed_at_bound().into_iter().map(|name| (name.to_owned(), (None, None))));
        if candidate.unloads_rigidly() {
            assessment.interval.insert("unloading_stiffness_n_per_m".to_owned(), (None, None));
            assessment.standard_deviation.remove("unloading_stiffness_n_per_m");
        }
        if candidate.is_of_sensors()
            && self.settings.solve.mass_fit != MassFit::Known
            && let Some(rest) = candidate.model.kind().parameters().iter().rfind(|p| p.kind == ParameterKind::Mass)
        {
            // Without any mass that was followed there is no word on the rest of the total.
            assessment.interval.entry(rest.name.to_owned()).or_insert((None, None));
        }
        let of_several = matches!(candidate.model, Model::DoubleSpringMassDamper(_) | Model::TripleSpringMassDamper(_));
        let given = self.settings.solve.triple.is_some() && matches!(candidate.model, Model::TripleSpringMassDamper(_));
        let front_mass_uncertainty =
            if of_several && at_minimum && !given { asked.front_mass_uncertainty } else { 0.0 };
        if of_several && at_minimum {
            uncertain.widen_by_mass_split(&mut assessment, front_mass_uncertainty);
        }
        assessment.hold(&candidate.model);
        let repeated = match candidate.method {
            Method::ClosedForm if candidate.fit.is_none() => "closed form",
            _ if is_conditioned(candidate) => "fit, from its own minimum each time,",
            _ => "fit",
        };
        let propagation = self.propagation(candidate, minimum);
        Some(Assessed { assessment, propagation, repeated, front_mass_uncertainty })
    }

    /// The estimator that made the values, repeated with uncertain inputs.
    fn propagation(&self, candidate: &Candidate, minimum: &Minimum) -> Option<Propagation> {
        let asked = &self.settings.assessment;
        let (inputs, repetitions) = (asked.inputs, asked.repetitions);
        if !inputs.any() {
            return None;
        }
        let events = FollowedEvents {
            time_of_dynamic_crush_s: self.events.time_of_dynamic_crush_s.unwrap_or(0.0),
            dynamic_crush_m: self.crush_m,
            coefficient_of_restitution: self.events.coefficient_of_restitution.unwrap_or(0.0),
        };
        match (candidate.method, &candidate.model) {
            _ if candidate.is_at_minimum() => {
                propagate(&minimum.model, &minimum.free, &minimum.observed, self.mass_kg, &inputs, repetitions)
            }
            _ if candidate.method == Method::ClosedForm
                || is_conditioned(candidate) && self.events.dynamic_crush_m.is_some() =>
            {
                let records = (&minimum.observed, self.whole.as_ref()?);
                events.propagate(&candidate.model, records, self.mass_kg, &inputs, repetitions)
            }
            _ => None,
        }
    }

    /// One remark for each thing that was asked for and does not belong to the values of a candidate.
    fn note_what_is_left_out(&self, candidates: &[Candidate], out: &mut Output) {
        let asked = &self.settings.assessment;
        let asked_for = |which: &dyn Fn(&str) -> bool| -> Vec<String> {
            asked.flags().into_iter().filter(|flag| which(flag)).map(str::to_owned).collect()
        };
        let flags = asked_for(&|flag| ["--profile", "--bootstrap"].contains(&flag));
        let assessed = || candidates.iter().filter_map(|candidate| Some((candidate, candidate.assessed.as_ref()?)));
        let elsewhere = assessed().filter(|(candidate, _)| !candidate.is_at_minimum());
        let elsewhere: Vec<String> = elsewhere.map(|(candidate, _)| candidate.id()).collect();
        if !flags.is_empty() && !elsewhere.is_empty() {
            out.notes().push(NotAtTheMinimum { flags, candidates: elsewhere });
        }
        let largest = asked.inputs.distributions[3].largest() * asked.inputs.contact_s;
        for (candidate, assessed) in assessed() {
            if assessed.propagation.is_some() && largest > ONE_MINIMUM_S && is_conditioned(candidate) {
                out.notes().push(OneMinimum { id: candidate.id(), beyond_s: ONE_MINIMUM_S });
            }
        }
        let inputs = asked_for(&|flag| flag.ends_with("-uncertainty"));
        for (candidate, assessed) in assessed() {
            if !inputs.is_empty() && assessed.propagation.is_none() {
                out.notes().push(NotPropagated { id: candidate.id(), inputs: inputs.clone() });
            }
        }
    }
}

/// Whether the values are those of the first nonlinear model under the conditions at dynamic crush.
fn is_conditioned(candidate: &Candidate) -> bool {
    matches!(candidate.method, Method::DirectFit | Method::InteriorPoint)
        && matches!(candidate.model, Model::Nonlinear1(_))
        && !candidate.is_of_sensors()
        && !candidate.is_at_minimum()
}

remarks! {
    /// Remarks of how well parameters are known.
    pub REMARKS;

    /// The vehicle does not stop within the record, so that no unloading shows.
    CR537 AssessedOverTheWindow {}
    bears on (About::Model(String::new()), Weight::None)
    decided "The events have no dynamic crush."
    means "Intervals hold for the loading within the fit window. Unloading and rebound are not known."
    remedy "nothing; a longer record shows the rebound"
    says "the vehicle does not stop within the record: models are assessed over the fit window, and their unloading is \
          not identifiable";

    /// How the displacement was filtered is not known.
    CR538 FilterNotKnown {}
    bears on (About::Model(String::new()), Weight::None)
    decided "No input says how the pulse was filtered before it was integrated."
    means "Models are compared with the displacement as it is. What a filter took off is taken for the vehicle."
    remedy "give the artifact of filter too"
    says "the filter of the record is not known here (the artifact of filter is not given, or the channel came \
          filtered): models are fitted as if the displacement had none";

    /// How well the parameters of a candidate are known could not be computed.
    CR539 NotAssessed { id: String, reason: String }
    bears on (About::Model(id.clone()), Weight::Marked)
    decided "The computation failed or reached its limit: the work of 250 million samples for each fit that intervals, \
             profile, bootstrap and repetitions ask for. An ordinary record takes a hundredth of it."
    means "The parameters have no intervals: they may be known well or not at all."
    remedy "leave profile and bootstrap out, or use another candidate"
    says format!("{id}: how well its parameters are known is {reason}");

    /// Profile and bootstrap were asked for and are not computed for some candidates.
    CR540 NotAtTheMinimum { flags: Vec<String>, candidates: Vec<String> }
    bears on (About::Model(String::new()), Weight::None)
    decided "Closed forms and methods of papers end elsewhere than at the least misfit through the filter of the \
             record."
    means "These candidates have the linearised intervals."
    remedy "nothing; candidates of direct-fit have profile and bootstrap"
    says format!(
        "{} not computed for {}: profile and bootstrap start at the minimum of a fit through the filter, and these \
         values are not that minimum",
        flags.join(" and "),
        candidates.join(", ")
    );

    /// Time zero is so uncertain that the first nonlinear model may have another minimum.
    CR541 OneMinimum { id: String, beyond_s: f64 }
    bears on (About::Model(id.clone()), Weight::Marked)
    decided "The values meet conditions at dynamic crush, and the largest drawn shift of time zero is above 0.25 ms."
    means "The propagated intervals may be too narrow."
    remedy "state time zero more exactly, or use the intervals of another model"
    says format!(
        "{id}: its repetitions start at its own minimum; with time zero more than {} ms off, another minimum can be \
         lower: the propagated intervals are those of one minimum and may be too narrow",
        1e3 * beyond_s
    );

    /// Stated uncertainties of inputs are not propagated to the parameters of a candidate.
    CR542 NotPropagated { id: String, inputs: Vec<String> }
    bears on (About::Model(id.clone()), Weight::Slight)
    decided "A fit at its least misfit is repeated with drawn inputs, and so is a closed form of the events. Values of \
             other methods are not, and neither are those whose repetitions fail."
    means "The candidate has no propagated intervals. Its other intervals stand."
    remedy "use a candidate that is fitted to the motion"
    says format!(
        "{id}: {} not propagated, its estimator cannot be repeated from this record",
        inputs.join(", ")
    );
}

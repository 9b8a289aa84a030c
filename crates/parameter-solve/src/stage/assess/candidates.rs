//! Follows every candidate through the measurement of the record and says how well its parameters are known.

use crumple_lumped::{Elastoplastic, Model, Nonlinear1, ParameterKind};
use crumple_lumped_fit::{
    AssessmentOptions, Candidate, CandidateNote, FollowedEvents, FreeParameter, MassFit, Measurement, Method,
    Observation, Propagation, RESOLUTION_M, Refined, assess, free_masses, free_parameters, largest_draw,
    largest_of_chain, mass_of, propagate, propagate_closed_form, propagate_conditioned, propagate_unfiltered, refine,
    unloads_rigidly,
};
use crumple_signal::{Displacement, Signal};
use crumple_stage::records::EventsV1;
use crumple_stage::{Inputs, Output, RefuseExt, Wave};
use rayon::prelude::*;

use crate::stage::assess::candidate_assessment::CandidateAssessment;
use crate::stage::assess::dual_pairs::{FitKind, drop_repeated, pair_up};
use crate::stage::assess::replace_by_refined::{WEIGHINGS, fixed_at_bound, replace_by_refined, weigh};
use crate::stage::assess::sensor_waves::SensorWaves;
use crate::stage::inputs::measurement::{UNKNOWN_FILTER_M, measurement};
use crate::stage::options::settings::StageSettings;

/// A fit under side conditions is replaced by the refined minimum where that meets them to this share of crush and
/// time: the filter itself moves the time of a crush that ends steeply by 0.1 ms and more.
const CONDITIONS: f64 = 5e-3;

/// Shift of time zero from which a fit under side conditions may have its least misfit in another minimum.
const ONE_MINIMUM_S: f64 = 2.5e-4;

/// Keeps the refinement within the stiff bounds of the search; springs and dampers may go to zero.
fn within_the_search(free: &mut [FreeParameter], model: &Model, window_s: f64) {
    let (stiffest, strongest) = largest_of_chain(mass_of(model), window_s);
    for parameter in free {
        let largest = match parameter.kind {
            ParameterKind::Damping => strongest,
            ParameterKind::Stiffness => stiffest,
            _ => continue,
        };
        parameter.limit = parameter.limit.min(largest.max(parameter.value));
    }
}

/// What all candidates share.
struct Assessor<'a> {
    settings: &'a StageSettings,
    events: &'a EventsV1,
    displacement: Signal<Displacement>,
    measurement: Measurement,
    /// Whether the filter of the record is known: only then a fit is replaced by the refined one.
    known: bool,
    /// Displacement from contact to its end, every sample: where events are read from.
    whole: Option<Observation>,
    sensors: &'a SensorWaves,
    mass_kg: Option<f64>,
    impact_speed_m_per_s: f64,
    crush_m: f64,
}

/// Refines the fits among `candidates` and assesses all of them; double pairs that turn out equal, or worse than the
/// record can tell, are taken out. The result goes with the candidates.
pub fn assess_all(
    candidates: &mut Vec<Candidate>,
    settings: &StageSettings,
    input: &Inputs,
    events: &EventsV1,
    mass_kg: Option<f64>,
    out: &mut Output,
) -> anyhow::Result<Vec<Option<CandidateAssessment>>> {
    let none = vec![None; candidates.len()];
    let wave = input.wave_if(&format!("{}/displacement", events.channel));
    let Some(displacement) = wave.map(Wave::signal::<Displacement>).transpose().refuse()? else { return Ok(none) };
    let test_speed = || input.test().ok().and_then(|test| test.impact_speed_m_per_s);
    let Some(impact_speed_m_per_s) = events.impact_speed_m_per_s.or_else(test_speed) else { return Ok(none) };
    // Of a vehicle that never stops the scale of the crush is the largest displacement.
    let largest = || displacement.samples().iter().copied().fold(0.0, f64::max);
    let crush_m = events.dynamic_crush_m.unwrap_or_else(largest);
    if crush_m <= 0.0 {
        return Ok(none);
    }
    if events.dynamic_crush_m.is_none() {
        out.notes().info(
            "the vehicle does not stop within the record: its models are assessed over the window of their fit and not \
             up to a dynamic crush; the record does not determine how they unload",
        );
    }
    settings.assessment.check(mass_kg, impact_speed_m_per_s)?;
    let (measurement, known) = measurement(input, events, &events.channel, &displacement)?;
    let end = (0.0, displacement.end_s() - events.time_zero_s);
    let whole =
        Observation::new(&displacement, events.time_zero_s, measurement, impact_speed_m_per_s, end, usize::MAX).ok();
    let sensors = SensorWaves::of(candidates, input, events, mass_kg)?;
    let scene = Assessor {
        settings,
        events,
        displacement,
        measurement,
        known,
        whole,
        sensors: &sensors,
        mass_kg,
        impact_speed_m_per_s,
        crush_m,
    };
    if !known {
        out.notes().info(
            "the filter of the record is not known here (give the artifact of crumple-filter too): models are fitted \
             as if the displacement had none",
        );
    }
    let mut refined: Vec<Option<(Observation, Refined)>> = candidates
        .par_iter()
        .map(|candidate| if candidate.shares_weights() { None } else { scene.refine(candidate, None) })
        .collect();
    // Sensors count by how well the best explanation meets them; further ones are seen with the same weights.
    let later: Vec<(usize, Option<(Observation, Refined)>)> = candidates
        .par_iter()
        .enumerate()
        .filter(|(_, candidate)| candidate.shares_weights())
        .map(|(k, candidate)| {
            let best = candidates.iter().position(|other| other.index == 1 && other.is_like(candidate));
            let best = best.and_then(|best| refined[best].as_ref()).map(|(observed, _)| observed);
            (k, best.and_then(|best| scene.refine(candidate, Some(best))))
        })
        .collect();
    for (k, minimum) in later {
        refined[k] = minimum;
    }
    let mut assessed: Vec<Option<CandidateAssessment>> = candidates
        .par_iter()
        .zip(&refined)
        .map(|(candidate, refined)| refined.as_ref().and_then(|(o, r)| scene.assess(candidate, o, r)))
        .collect();
    scene.note_what_is_left_out(candidates, &refined, &assessed, out);
    for (candidate, minimum) in candidates.iter_mut().zip(&refined) {
        if let Some((observed, refined)) = minimum
            && scene.is_replaced_by_refined(candidate, refined)
        {
            replace_by_refined(candidate, observed, refined);
            if let Model::Elastoplastic(model) = candidate.model {
                let chosen =
                    if model.release { "leaves the barrier at rebound" } else { "stays attached and swings on" };
                candidate.notes.push(CandidateNote::info(format!(
                    "the model {chosen}: fits the record up to rebound better than the alternative"
                )));
            }
        }
    }
    drop_repeated(candidates, &mut assessed, out);
    if scene.known {
        pair_up(candidates, &mut assessed, out);
    }
    Ok(assessed)
}

impl Assessor<'_> {
    fn window(&self, candidate: &Candidate) -> Option<(f64, f64)> {
        if let (Model::Elastoplastic(_), Some(rebound)) = (&candidate.model, self.events.time_of_rebound_s) {
            // The unloading shows between dynamic crush and rebound only.
            return Some((self.settings.solve.fit_from_s, rebound));
        }
        match &candidate.fit {
            Some(fit) => Some((fit.from_s, fit.to_s)),
            None => Some((
                self.settings.solve.fit_from_s,
                self.settings.solve.fit_to_s.or(self.events.time_of_dynamic_crush_s)?,
            )),
        }
    }

    /// Whether the filter of everything that the candidate was fitted to is known.
    fn known(&self, candidate: &Candidate) -> bool {
        if candidate.of_sensors() { self.sensors.known(candidate) } else { self.known }
    }

    fn observed(&self, candidate: &Candidate) -> Option<Observation> {
        let window = self.window(candidate)?;
        let samples = self.settings.solve.fit_samples;
        let (zero, v0) = (self.events.time_zero_s, self.impact_speed_m_per_s);
        let mut observed = if candidate.of_sensors() {
            Observation { impact_speed_m_per_s: v0, waves: self.sensors.seen(candidate, zero, window, samples)? }
        } else {
            Observation::new(&self.displacement, zero, self.measurement, v0, window, samples).ok()?
        };
        if !self.known(candidate) {
            for wave in &mut observed.waves {
                wave.resolution *= UNKNOWN_FILTER_M / RESOLUTION_M;
            }
        }
        Some(observed)
    }

    /// Follows the candidate to its minimum; several sensors weighted as `weighted` has them, else by their own
    /// misfits.
    fn refine(&self, candidate: &Candidate, weighted: Option<&Observation>) -> Option<(Observation, Refined)> {
        if candidate.method == Method::CoefficientMatching || candidate.is_second_of_pair() {
            return None;
        }
        let mut observed = self.observed(candidate)?;
        for (wave, other) in observed.waves.iter_mut().zip(weighted.iter().flat_map(|other| &other.waves)) {
            wave.weight = other.weight;
        }
        let with = |model: &Model, observed: &Observation| {
            let mut free = free_parameters(model, self.impact_speed_m_per_s, self.crush_m, true);
            if let (true, MassFit::Shares { lower, upper }) = (candidate.of_sensors(), self.settings.solve.mass_fit) {
                free.extend(free_masses(model, (lower, upper)));
            }
            free.retain(|parameter| !fixed_at_bound(candidate).any(|name| name == parameter.name));
            if let Some(fit) = &candidate.fit
                && matches!(model, Model::DoubleSpringMassDamper(_) | Model::TripleSpringMassDamper(_))
            {
                within_the_search(&mut free, model, fit.to_s);
            }
            refine(model, &free, observed)
        };
        let mut minimum = match &candidate.model {
            // Whether the vehicle leaves the barrier or swings on: what fits the record better.
            Model::Elastoplastic(model) if !candidate.of_sensors() => {
                let both = [true, false]
                    .map(|release| with(&Model::Elastoplastic(Elastoplastic { release, ..*model }), &observed));
                both.into_iter().flatten().min_by(|a, b| a.rmse_m().total_cmp(&b.rmse_m()))
            }
            model => with(model, &observed),
        }?;
        // The noise levels of several sensors are those of the misfit through the filter.
        for _ in 0..if weighted.is_none() { WEIGHINGS } else { 0 } {
            if !weigh(&mut observed, &minimum) {
                break;
            }
            minimum = refine(&minimum.model, &minimum.free, &observed)?;
        }
        Some((observed, minimum))
    }

    /// Whether the candidate is a fit that the minimum through the filter replaces.
    fn is_replaced_by_refined(&self, candidate: &Candidate, refined: &Refined) -> bool {
        if !self.known(candidate) || candidate.method != Method::DirectFit {
            return false;
        }
        match &refined.model {
            Model::Nonlinear1(model) if !candidate.of_sensors() => self.meets_conditions(model),
            _ => true,
        }
    }

    /// The side conditions of the first nonlinear model.
    fn meets_conditions(&self, model: &Nonlinear1) -> bool {
        let events = Model::Nonlinear1(*model).events(self.impact_speed_m_per_s).ok();
        let crush = events.as_ref().and_then(|e| e.dynamic_crush_m);
        let time = events.as_ref().and_then(|e| e.time_of_dynamic_crush_s).zip(self.events.time_of_dynamic_crush_s);
        let ordered = model.k1_n_per_m <= model.k2_n_per_m
            && model.c1_n_s_per_m >= model.c2_n_s_per_m
            && model.c2_n_s_per_m >= model.c3_n_s_per_m;
        if self.events.dynamic_crush_m.is_none() {
            return ordered;
        }
        ordered
            && crush.is_some_and(|crush| (crush / self.crush_m - 1.0).abs() <= CONDITIONS)
            && time.is_some_and(|(of_model, of_record)| (of_model / of_record - 1.0).abs() <= CONDITIONS)
    }

    /// Whether the values assessed are those of the minimum at which profile and bootstrap start.
    fn is_minimum(&self, candidate: &Candidate, refined: &Refined) -> bool {
        let fitted = match candidate.method {
            Method::DirectFit => candidate.of_sensors() || !matches!(candidate.model, Model::Nonlinear1(_)),
            Method::LShade => true,
            _ => false,
        };
        self.is_replaced_by_refined(candidate, refined) || (fitted && !self.known(candidate))
    }

    fn assess(&self, candidate: &Candidate, observed: &Observation, refined: &Refined) -> Option<CandidateAssessment> {
        let asked = &self.settings.assessment;
        let at_minimum = self.is_minimum(candidate, refined);
        let options = if at_minimum { asked.options() } else { AssessmentOptions::default() };
        let given = (!self.is_replaced_by_refined(candidate, refined)).then_some(&candidate.model);
        let mut assessment = assess(refined, given, observed, options)?;
        assessment.interval.extend(fixed_at_bound(candidate).map(|name| (name, (None, None))));
        if let (Method::ClosedForm, Model::Elastoplastic(model)) = (candidate.method, &candidate.model)
            && unloads_rigidly(model)
        {
            assessment.interval.insert("unloading_stiffness_n_per_m", (None, None));
            assessment.standard_deviation.remove("unloading_stiffness_n_per_m");
        }
        if candidate.of_sensors()
            && self.settings.solve.mass_fit != MassFit::Known
            && let Some(rest) = candidate.model.kind().parameters().iter().rfind(|p| p.kind == ParameterKind::Mass)
        {
            // Without any mass that was followed there is no word on the rest of the total.
            assessment.interval.entry(rest.name).or_insert((None, None));
        }
        let propagation = self.propagation(candidate, observed, refined);
        let repeated = if candidate.method == Method::ClosedForm && candidate.fit.is_none() {
            "closed form"
        } else if self.is_conditioned(candidate, refined) {
            "fit, from its own minimum each time,"
        } else {
            "fit"
        };
        Some(CandidateAssessment { assessment, propagation, repeated, through_filter: self.known(candidate) })
    }

    /// Whether the values are those of the first nonlinear model under the conditions at dynamic crush.
    fn is_conditioned(&self, candidate: &Candidate, refined: &Refined) -> bool {
        matches!(candidate.method, Method::DirectFit | Method::InteriorPoint)
            && matches!(candidate.model, Model::Nonlinear1(_))
            && !candidate.of_sensors()
            && !self.is_replaced_by_refined(candidate, refined)
    }

    /// The estimator that made the values, repeated with uncertain inputs.
    fn propagation(&self, candidate: &Candidate, observed: &Observation, refined: &Refined) -> Option<Propagation> {
        let asked = &self.settings.assessment;
        let inputs = asked.inputs();
        if !inputs.any() {
            return None;
        }
        let values = candidate.model.parameters();
        let mass_kg = self.mass_kg.unwrap_or_else(|| mass_of(&candidate.model));
        let repetitions = asked.repetitions;
        let events = FollowedEvents {
            time_of_dynamic_crush_s: self.events.time_of_dynamic_crush_s.unwrap_or(0.0),
            dynamic_crush_m: self.crush_m,
            coefficient_of_restitution: self.events.coefficient_of_restitution.unwrap_or(0.0),
        };
        match (candidate.method, &candidate.model) {
            _ if self.is_replaced_by_refined(candidate, refined) => {
                propagate(&refined.model, &refined.free, observed, mass_kg, &inputs, repetitions)
            }
            (Method::ClosedForm, model) => {
                propagate_closed_form(model, &events, self.whole.as_ref()?, mass_kg, &inputs, repetitions)
            }
            (_, Model::Nonlinear1(_)) if !candidate.of_sensors() && self.events.dynamic_crush_m.is_none() => None,
            (Method::DirectFit | Method::InteriorPoint, Model::Nonlinear1(model)) if !candidate.of_sensors() => {
                let records = (observed, self.whole.as_ref()?);
                propagate_conditioned(model, &events, records, mass_kg, &inputs, repetitions)
            }
            (Method::DirectFit | Method::LShade, model) => {
                let described = |p: &FreeParameter| p.described_at(values[p.name]);
                let free: Vec<FreeParameter> = refined.free.iter().map(described).collect();
                propagate_unfiltered(model, &free, observed, mass_kg, &inputs, repetitions)
            }
            _ => None,
        }
    }

    /// One remark for each thing that was asked for and does not belong to the values of a candidate.
    fn note_what_is_left_out(
        &self,
        candidates: &[Candidate],
        refined: &[Option<(Observation, Refined)>],
        assessed: &[Option<CandidateAssessment>],
        out: &mut Output,
    ) {
        let asked = &self.settings.assessment;
        let flags: Vec<&str> =
            asked.flags().into_iter().filter(|flag| ["--profile", "--bootstrap"].contains(flag)).collect();
        let all = || candidates.iter().zip(refined).zip(assessed);
        let elsewhere: Vec<String> = all()
            .filter(|((candidate, refined), assessed)| {
                assessed.is_some() && refined.as_ref().is_some_and(|(_, r)| !self.is_minimum(candidate, r))
            })
            .map(|((candidate, _), _)| candidate.id())
            .collect();
        if !flags.is_empty() && !elsewhere.is_empty() {
            out.notes().info(format!(
                "{} not computed for {}: profile and bootstrap start at the minimum of a fit through the filter, and \
                 these values are not that minimum",
                flags.join(" and "),
                elsewhere.join(", ")
            ));
        }
        let largest = largest_draw(asked.distributions[3]) * asked.time_zero_uncertainty_s;
        for ((candidate, refined), assessed) in all() {
            let repeated = assessed.as_ref().is_some_and(|assessed| assessed.propagation.is_some());
            if repeated
                && largest > ONE_MINIMUM_S
                && refined.as_ref().is_some_and(|(_, r)| self.is_conditioned(candidate, r))
            {
                out.notes().warning(format!(
                    "{}: its repetitions start at its own minimum; with time zero more than {} ms off, another minimum \
                     can be lower: the propagated intervals are those of one minimum and may be too narrow",
                    candidate.id(),
                    1e3 * ONE_MINIMUM_S
                ));
            }
        }
        let inputs: Vec<&str> = asked.flags().into_iter().filter(|flag| flag.ends_with("-uncertainty")).collect();
        for ((candidate, _), assessed) in all() {
            if !inputs.is_empty() && assessed.as_ref().is_some_and(|assessed| assessed.propagation.is_none()) {
                out.notes().warning(format!(
                    "{}: {} not propagated, its estimator cannot be repeated from this record",
                    candidate.id(),
                    inputs.join(", ")
                ));
            }
        }
    }
}

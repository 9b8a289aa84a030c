//! The program: reads the events and the motion, solves, assesses, writes the candidates.

mod assess;
mod chains;
mod comparison;
mod identified;
mod inputs;
mod options;
mod own_models;
mod recommendation;
mod records;
mod settings;
mod several_tests;

use std::path::PathBuf;

use crumple_lumped_fit::{
    CLOSED_FORM_REMARKS, Candidate, JOINT_REMARKS, LOAD_PATH_REMARKS, MATCHING_REMARKS, MassSplit, Method,
    PLACE_REMARKS, SENSOR_REMARKS, SINGLE_MASS_REMARKS, SOLVE_REMARKS, match_as_the_paper_typed,
};
use crumple_signal::{About, Kind, TestDescription, Weight, remarks};
use crumple_stage::records::{EventsV1, TestV1};
use crumple_stage::{Inputs, LeftOut, Loaded, Outcome, Output, Stage, Tests};

use crate::stage::assess::assess_all;
use crate::stage::chains::{called, fit_stated};
use crate::stage::identified::{from_exponentials, from_models, maxwell_candidates};
use crate::stage::inputs::{
    Displaced, Record, from_events, not_slowed, pulse_displacement, up_to_the_end_of_the_event,
};
use crate::stage::options::Options;
use crate::stage::recommendation::{compared, recommend};
use crate::stage::records::{matching_record, write_candidates};
use crate::stage::settings::StageSettings;
use crate::stage::several_tests::from_several;

/// The stage.
pub struct ParameterSolve;

impl Stage for ParameterSolve {
    const NAME: &'static str = "parameter-solve";
    const BUILD: &'static str = env!("CRUMPLE_BUILD");
    const ABOUT: &'static str = "Finds the springs and dampers of lumped crash models, from the crash events and the \
         displacement of a test, or one model for several tests: each path then has the name of \
         its test in front, NAME:PATH.";
    const LEFT_OUT: &'static [LeftOut] = &[LeftOut {
        option: "time_zero_uncertainty",
        value: "",
        instead: "give it to ingest; it is propagated where mass-uncertainty, speed-uncertainty or bias-uncertainty is",
    }];
    const REMARKS: &'static [&'static [&'static Kind]] = &[
        JOINT_REMARKS,
        MATCHING_REMARKS,
        CLOSED_FORM_REMARKS,
        PLACE_REMARKS,
        LOAD_PATH_REMARKS,
        SENSOR_REMARKS,
        SINGLE_MASS_REMARKS,
        SOLVE_REMARKS,
        assess::REMARKS,
        chains::REMARKS,
        comparison::REMARKS,
        identified::REMARKS,
        inputs::REMARKS,
        REMARKS,
        several_tests::REMARKS,
    ];
    type Options = Options;
    type Settings = StageSettings;
    type Input = Tests;

    fn resolve(options: Options) -> anyhow::Result<StageSettings> {
        options.try_into()
    }

    fn load(paths: &[PathBuf], _: &StageSettings) -> anyhow::Result<Loaded<Tests>> {
        crumple_stage::load_tests(paths)
    }

    fn run(settings: &StageSettings, input: &Tests, out: &mut Output) -> anyhow::Result<Outcome> {
        let input = match input {
            Tests::One(input) => input,
            Tests::Several(tests) => return from_several(settings, tests, out),
        };
        let described = input.record_if::<TestV1>("/test")?.is_some().then(|| input.test()).transpose()?;
        let contact = described.and_then(|test| test.contact);
        let settings = &settings.with_contact(contact.and_then(|contact| contact.uncertainty_s));
        let events = input.record_if::<EventsV1>("/events")?;
        let displacement = events.as_ref().map(|events| pulse_displacement(input, events)).transpose()?.flatten();
        let windowed = events.as_ref().and_then(|events| up_to_the_end_of_the_event(settings, events, out));
        let settings = windowed.as_ref().unwrap_or(settings);
        let mut candidates = Vec::new();
        let mut test = None;
        if settings.solve.needs_events() {
            let events = events.as_ref().ok_or_else(|| input.missing("/events"))?;
            let described = input.test()?;
            if let Some((reason, remedy)) = unsolvable(settings, displacement.as_ref(), events, &described) {
                out.remedy(remedy);
                out.put("/test", &input.test_with_samples(&described))?;
                return Ok(Outcome::NoAcceptableResult(reason));
            }
            let record = Record::read(settings, input, &described, (events, displacement.clone()), out)?;
            candidates = from_events(settings, &record, events, out)?;
            assess_all(&mut candidates, settings, &record, events, out)?;
            test = Some(described);
        } else if input.record_if::<TestV1>("/test")?.is_some() {
            test = Some(input.test()?);
        }
        if let Some(test) = &test {
            out.put("/test", &input.test_with_samples(test))?;
        }
        let mass_kg = settings.mass_kg.or(test.as_ref().and_then(|test| test.mass_kg));
        candidates.extend(of_identified_models(settings, input, mass_kg, out)?);
        warn_of_flags_without_effect(settings, &candidates, out);
        warn_of_bounds(&candidates, out);
        candidates.extend(fit_stated(settings, input, events.as_ref(), out)?);
        let channel = events.as_ref().map_or("", |events| &events.channel);
        if candidates.is_empty() {
            return Ok(none_solved(out));
        }
        let record = events.as_ref().map(|events| (events, displacement.as_ref()));
        let comparison = compared(settings, input, record, out.notes())?;
        let assessed = write_candidates(&candidates, channel, comparison.as_ref().ok(), out)?;
        if assessed.is_empty() {
            return Ok(none_solved(out));
        }
        recommend(settings, &comparison, &assessed, out)?;
        Ok(Outcome::Done)
    }
}

fn none_solved(out: &mut Output) -> Outcome {
    out.no_result("no model could be solved for", "leave models and method out, so that all are tried")
}

/// Why nothing can be solved for in this test, if so, and what to do. No fault of the artifact: the report shall still
/// be made.
fn unsolvable(
    settings: &StageSettings,
    displacement: Option<&Displaced>,
    events: &EventsV1,
    test: &TestDescription,
) -> Option<(String, String)> {
    if settings.mass_kg.or(test.mass_kg).is_none() && !matches!(settings.solve.split, MassSplit::Both(..)) {
        // Ingest was told to go on without a mass.
        return Some((
            "the test has no mass, which turns frequencies into N/m".to_owned(),
            "state it: --mass 873kg at ingest, or '# mass: 873 kg' in the header of the record".to_owned(),
        ));
    }
    not_slowed(displacement, events).map(|(reason, remedy)| (reason.to_owned(), remedy))
}

/// Candidates that need no motion: by coefficient matching, from the paper's printed polynomial, from sums of
/// exponentials.
fn of_identified_models(
    settings: &StageSettings,
    input: &Inputs,
    mass_kg: Option<f64>,
    out: &mut Output,
) -> anyhow::Result<Vec<Candidate>> {
    let mut candidates = Vec::new();
    if settings.solve.uses(Method::CoefficientMatching) {
        candidates.extend(from_models(settings, input, mass_kg, out)?);
    }
    if settings.paper.is_some() {
        let first = candidates.len() + 1;
        let ids = ["one-fifth-in-front", "four-fifths-in-front"];
        for (id, matched) in ids.into_iter().zip(match_as_the_paper_typed(first, out.notes())?) {
            let source = "printed denominator of the transfer-function paper";
            out.put(&format!("/matching/tfest-paper/{id}"), &matching_record(&matched, source))?;
            candidates.extend(matched.candidates);
        }
    }
    if settings.solve.uses(Method::CurveFit) {
        candidates.extend(from_exponentials(settings, input, mass_kg, out)?);
    }
    candidates.extend(maxwell_candidates(settings, input, mass_kg, out)?);
    Ok(candidates)
}

/// Warns of flags on uncertainty that have no effect on candidates that follow no motion. A failed assessment
/// has its own note.
fn warn_of_flags_without_effect(settings: &StageSettings, candidates: &[Candidate], out: &mut Output) {
    let flags: Vec<String> = settings.assessment.flags().into_iter().map(str::to_owned).collect();
    let unassessed = candidates.iter().filter(|candidate| candidate.assessed.is_none() && candidate.minimum.is_none());
    let unassessed: Vec<String> = unassessed.map(Candidate::id).collect();
    if !flags.is_empty() && !unassessed.is_empty() {
        out.notes().push(FlagsWithoutEffect { flags, candidates: unassessed });
    }
}

/// Warns of parameters that stopped on a bound of the search, once for a pair of duals: both stand on the same bounds.
fn warn_of_bounds(candidates: &[Candidate], out: &mut Output) {
    for candidate in candidates {
        let dual = candidate.equivalent_to.is_some_and(|other| other < candidate.index);
        let words = candidate.in_words(candidate.fixed_at_bound());
        if !dual && !words.is_empty() {
            out.notes().push(AtSearchLimit { id: candidate.id(), names: words });
        }
    }
}

remarks! {
    /// Remarks of the stage as a whole.
    pub REMARKS;

    /// Flags on uncertainty were given that have no effect on some candidates.
    CR562 FlagsWithoutEffect { flags: Vec<String>, candidates: Vec<String> }
    bears on (About::Model(String::new()), Weight::Slight)
    decided "A candidate is assessed by its least misfit to the motion; these follow no motion."
    means "These candidates have no intervals of the kind that is asked for."
    remedy "use a candidate that is fitted to the motion"
    says format!(
        "{} without effect on {}: only candidates from the events and the motion of the pulse are assessed",
        flags.join(", "),
        candidates.join(", ")
    );

    /// Parameters of a model stopped at a limit of the search.
    CR563 AtSearchLimit { id: String, names: String }
    bears on (About::Model(id.clone()), Weight::Marked)
    decided "The least misfit lies on a limit of the search, or beyond it. Of the models of the stage no limit of zero \
             is named, since a spring or damper of zero is an answer; of a stated chain it is."
    means "The limit makes the value, not the vehicle. It has no interval."
    remedy "quote no value for these parameters; use a model with fewer of them, or a sensor on each mass"
    says {
        let called = called(id);
        format!("{called}: parameters at a search limit, not identifiable from this record: {names}")
    };
}

//! What speaks against a run, ranked by what it does to what is shown.

use crate::drawing::numbers::MILLI;
use crate::phrases::PHRASES;
use crate::phrases::words;
use crate::phrases::words::fill;
use crumple_artifact::records::{Certainty, ConcernV1, RemarkV1, SeverityV1};
use crumple_signal::{About, Severity, Weight};

use crate::findings::conclusions::key_numbers::{KeyNumber, key_numbers};
use crate::findings::conclusions::kind::Kind;
use crate::findings::conclusions::several_tests::missed;
use crate::findings::text::candidate_name;
use crate::findings::text::symbols;
use crate::findings::{Ranking, Run};

/// Warnings that stand on the first screen.
pub const SHOWN_FIRST: usize = 3;

/// Largest weight of a concern of a run: what it changes (1 to 3) times how prominently the page shows that (1 to 3).
const LARGEST_WEIGHT: u8 = 9;

/// Number, from 1, and subject of the first warning of a stage that what the page shows first may be another thing than
/// it is taken for. That mass or speed is not stated makes nothing else of what is shown.
pub fn decisive_warning<'a>(run: &Run, concerns: &'a [ConcernV1]) -> Option<(usize, &'a str)> {
    let is_absent = |about: &str| match about.parse() {
        Ok(About::Mass) => run.test.mass_kg.is_none(),
        Ok(About::ImpactSpeed) => run.test.impact_speed_m_per_s.is_none(),
        _ => false,
    };
    let is_decisive = |c: &ConcernV1| c.weight == LARGEST_WEIGHT && c.stage != "report" && !is_absent(&c.about);
    warnings(concerns).zip(1..).find(|(c, _)| is_decisive(c)).map(|(concern, number)| (number, concern.about.as_str()))
}

/// The concerns of a run, weighed from 1 to `LARGEST_WEIGHT`: the diagnosis of a stage without a result, what the
/// results contradict each other in, then, gravest first, the warnings of the stages and what follows from the results
/// themselves. No two of the first `SHOWN_FIRST` concern the same thing where others
/// are as grave within one step of how much they change.
pub fn concerns(run: &Run, ranking: &Ranking, kind: Kind) -> Vec<ConcernV1> {
    let mut all: Vec<ConcernV1> = run.concerns.iter().map(|record| of_record(record, run, ranking, kind)).collect();
    for note in run.notes.iter().filter(|note| note.note.severity == Severity::Warning) {
        if !all.iter().any(|known| known.stage == note.stage && known.text == note.note.text) {
            let about = About::of_stage(&note.stage);
            all.push(concern(&note.stage, about, Weight::Slight, note.note.text.clone(), run, ranking, kind));
        }
    }
    for (about, weight, text) in of_results(run, ranking, kind) {
        all.push(concern("report", about, weight, text, run, ranking, kind));
    }
    // Of another record nobody asks for the mass of a vehicle.
    let is_asked = |concern: &ConcernV1| {
        kind != Kind::InputOutput || !concern.about.parse().is_ok_and(|about| is_of_a_crash(&about))
    };
    all.retain(is_asked);
    // The sort is stable: equals stay in the order of the stages.
    all.sort_by_key(|concern| (!concern.is_no_result(), std::cmp::Reverse(concern.weight), order_of(&concern.about)));
    let mut all = one_each_first(all);
    // What else is said follows from what contradicts itself.
    let remarks = run.remarks.iter().map(|remark| of_remark(remark, run, ranking, kind)).filter(is_asked);
    let after_the_diagnoses = all.iter().take_while(|concern| concern.is_no_result()).count();
    all.splice(after_the_diagnoses..after_the_diagnoses, remarks);
    all
}

/// Of the gravest ones those that concern different things come first.
fn one_each_first(all: Vec<ConcernV1>) -> Vec<ConcernV1> {
    let (mut first, mut others): (Vec<ConcernV1>, Vec<ConcernV1>) = (Vec::new(), Vec::new());
    for concern in all {
        let is_new = first.iter().all(|known| known.about != concern.about);
        if first.len() < SHOWN_FIRST && is_new { first.push(concern) } else { others.push(concern) }
    }
    first.extend(others);
    first
}

fn order_of(about: &str) -> Option<About> {
    about.parse().ok()
}

fn of_record(record: &ConcernV1, run: &Run, ranking: &Ranking, kind: Kind) -> ConcernV1 {
    let about = record.about.parse().unwrap_or(About::Record);
    let weight = Weight::of_number(record.weight);
    let concern = concern(&record.stage, about, weight, record.text.clone(), run, ranking, kind);
    ConcernV1 { severity: record.severity, remedy: record.remedy.clone(), ..concern }
}

fn of_remark(remark: &RemarkV1, run: &Run, ranking: &Ranking, kind: Kind) -> ConcernV1 {
    let about = remark.about.parse().unwrap_or(About::Record);
    let weight = Weight::of_number(remark.weight);
    let text = match &remark.written_by {
        Some(program) => format!("{}; written by {program}", remark.text),
        None => remark.text.clone(),
    };
    let concern = concern(&remark.stage, about, weight, text, run, ranking, kind);
    ConcernV1 { remedy: remark.remedy.clone(), ..concern }
}

fn concern(
    stage: &str,
    about: About,
    changes: Weight,
    text: String,
    run: &Run,
    ranking: &Ranking,
    kind: Kind,
) -> ConcernV1 {
    ConcernV1 {
        stage: stage.to_owned(),
        severity: SeverityV1::Warning,
        weight: changes.number() * prominence(&about, run, ranking, kind),
        about: about.to_string(),
        text,
        remedy: None,
    }
}

/// The warnings of a run, which every surface counts alike: the diagnosis of a stage without a result is none.
pub fn warnings(concerns: &[ConcernV1]) -> impl Iterator<Item = &ConcernV1> {
    concerns.iter().filter(|concern| !concern.is_no_result())
}

/// Of the warnings in their order those for the first screen: at most `SHOWN_FIRST`, none that is said elsewhere, none
/// of a candidate that nobody recommends, no failed method; and how many are left of all.
pub fn first_warnings<'a>(
    concerns: &'a [ConcernV1],
    is_said: impl Fn(&ConcernV1) -> bool,
    run: &Run,
    ranking: &Ranking,
) -> (Vec<&'a ConcernV1>, usize) {
    let is_prominent =
        |concern: &&ConcernV1| !is_of_a_failed_method(concern) && !is_of_another_candidate(concern, run, ranking);
    let own = warnings(concerns).filter(|concern| !is_said(concern));
    let first: Vec<&ConcernV1> = own.filter(is_prominent).take(SHOWN_FIRST).collect();
    let others = warnings(concerns).count() - first.len();
    (first, others)
}

/// Whether a concern says why an identification method gave no model: such concerns have a list of their own.
pub fn is_of_a_failed_method(concern: &ConcernV1) -> bool {
    matches!(concern.about.parse(), Ok(About::Method(_)))
}

/// What only a crash has: of another record nobody asks for it.
fn is_of_a_crash(about: &About) -> bool {
    matches!(about, About::Pulse | About::Mass | About::ImpactSpeed | About::Motion)
}

/// Whether a concern is of a candidate that nobody recommends: neither for predictions, nor as the simplest or closest.
pub fn is_of_another_candidate(concern: &ConcernV1, run: &Run, ranking: &Ranking) -> bool {
    match concern.about.parse() {
        Ok(About::Model(name)) => prominence_of_model(&name, run, ranking) == 1,
        _ => false,
    }
}

/// How prominently the page shows what a concern is about: 3 on the first screen, 2 in a section of its own, 1 on
/// demand.
fn prominence(about: &About, run: &Run, ranking: &Ranking, kind: Kind) -> u8 {
    match about {
        // Of a record that is no crash the models come first.
        About::Time if kind == Kind::InputOutput => 2,
        About::Pulse | About::Mass | About::ImpactSpeed | About::Time | About::Motion => 3,
        About::Model(name) => prominence_of_model(name, run, ranking),
        About::Predictions | About::WallForce | About::Record => 2,
        About::Occupants => 2 + u8::from(kind == Kind::Occupant),
        About::IdentifiedModels if kind == Kind::InputOutput => 3,
        // Beside a model of a crash without mass or speed stand the numbers of the pulse, which hold.
        About::IdentifiedModels => 1 + u8::from(kind == Kind::LinearModel),
        About::Method(_) | About::Channel(_) => 1,
    }
}

fn prominence_of_model(name: &str, run: &Run, ranking: &Ranking) -> u8 {
    let is_of = |id: Option<&str>| id.is_some_and(|id| id == name || id.split('/').next() == Some(name));
    let choice = run.recommendation.as_ref();
    let named = |id: Option<&String>| is_of(id.map(String::as_str));
    if is_of(ranking.best.as_deref()) {
        3
    } else if name.is_empty() || choice.is_some_and(|c| named(c.simplest.as_ref()) || named(c.closest.as_ref())) {
        2
    } else {
        1
    }
}

/// What follows from typed fields of the results, whatever the stages remarked.
fn of_results(run: &Run, ranking: &Ranking, kind: Kind) -> Vec<(About, Weight, String)> {
    let phrases = &PHRASES.conclusion;
    let mut found = Vec::new();
    if kind == Kind::TwoVehicles {
        found.push((About::Motion, Weight::Decisive, phrases.warn_two_vehicles.to_owned()));
    }
    let numbers = key_numbers(run);
    let bound = numbers.iter().find(|number| number.is_lower_bound);
    let is_of = |id: &&String| bound.is_some_and(|bound| bound.channels.contains(id));
    let channels: Vec<&str> = run.clipped.iter().filter(is_of).map(String::as_str).collect();
    if kind == Kind::Occupant && !channels.is_empty() {
        let text = fill(phrases.warn_clipped, &[("channels", channels.join(", "))]);
        found.push((About::Occupants, Weight::Decisive, text));
    }
    let crush = numbers.into_iter().find(|number| number.name == "dynamic_crush");
    if let Some(spread) = crush.filter(KeyNumber::interval_misses_a_sensor).and_then(|crush| crush.spread) {
        let mm = |m: f64| words::quantity(MILLI * m, 0, "mm");
        let texts = [("count", spread.sensors().to_string()), ("low", mm(spread.low)), ("high", mm(spread.high))];
        let text = fill(phrases.sensors_differ, &texts);
        found.push((About::Motion, Weight::Marked, text));
    }
    if let Some(tests) = run.joint.as_ref().and_then(missed) {
        let text = fill(PHRASES.joint.warn_missed, &[("tests", tests)]);
        found.push((About::Predictions, Weight::Decisive, text));
    }
    if let Some(best) = ranking.best.as_deref().and_then(|id| run.candidate(id)) {
        let model = candidate_name(&best.id);
        let about = || About::Model(best.id.clone());
        // In the order in which the verdict distrusts them.
        if best.record.equivalent_to.is_some() {
            found.push((about(), Weight::Marked, fill(phrases.warn_dual, &[("model", &model)])));
        }
        for (names, template, weight) in [
            (best.record.undetermined(), phrases.warn_open, Weight::Decisive),
            (best.record.parameters_of(Certainty::OrderOfMagnitude), phrases.warn_hardly, Weight::Marked),
        ] {
            if !names.is_empty() {
                let names = symbols(&best.record, &names);
                found.push((about(), weight, fill(template, &[("names", &names), ("model", &model)])));
            }
        }
    }
    if let Some(crush_m) = run.exceeded_tested_crush_m(|p| p.recommended) {
        let text = fill(phrases.warn_extrapolates, &[("crush", words::quantity(MILLI * crush_m, 0, "mm"))]);
        found.push((About::Predictions, Weight::Slight, text));
    }
    found
}

//! What speaks against a run, ranked by what it does to what is shown.

use crumple_artifact::records::{RemarkV1, SeverityV1};
use crumple_signal::{About, Weight};
use crumple_stage::is_no_result;
use serde::{Deserialize, Serialize};

use crate::findings::conclusions::kind::{Kind, kind_of};
use crate::findings::conclusions::own_remarks::own_remarks;
use crate::findings::{Ranking, Run};

/// A warning of a run as its surfaces show it, or the diagnosis of a stage without a result.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(default)]
#[cfg_attr(feature = "schemas", schemars(!default))]
pub struct Concern {
    /// The stage that says it.
    pub stage: String,
    /// How severe it is.
    pub severity: SeverityV1,
    /// What it concerns, as in `/remarks`.
    pub about: String,
    /// What it changes (1 to 3) times how prominently the page shows that (1 to 3).
    pub weight: u8,
    /// One sentence.
    pub text: String,
    /// One thing to do about it, where the sentence does not say it.
    pub remedy: Option<String>,
    /// Its code: `crumple explain CODE`. Empty: a sentence of a program that gives none.
    pub code: String,
}

impl Concern {
    fn new(remark: &RemarkV1, prominence: u8) -> Self {
        Self {
            stage: remark.stage.clone(),
            severity: if is_no_result(remark) { SeverityV1::NoResult } else { SeverityV1::Warning },
            about: subject(remark).to_string(),
            weight: Weight::of_number(remark.weight).number() * prominence,
            text: remark.text.clone(),
            remedy: remark.remedy.clone(),
            code: remark.code.clone(),
        }
    }

    /// Whether it is the diagnosis of a stage without a result.
    pub fn is_no_result(&self) -> bool {
        self.severity == SeverityV1::NoResult
    }

    /// Its sentence with its code behind it.
    pub fn with_code(&self) -> String {
        if self.code.is_empty() { self.text.clone() } else { format!("{} [{}]", self.text, self.code) }
    }
}

/// Warnings that stand on the first screen.
pub const SHOWN_FIRST: usize = 3;

/// Largest weight of a concern of a run: what it changes (1 to 3) times how prominently the page shows that (1 to 3).
const LARGEST_WEIGHT: u8 = 9;

/// Number, from 1, and subject of the first warning of a stage that what the page shows first may be another thing than
/// it is taken for. That mass or speed is not stated makes nothing else of what is shown.
pub fn decisive_warning<'a>(run: &Run, concerns: &'a [Concern]) -> Option<(usize, &'a str)> {
    let is_absent = |c: &Concern| c.about.parse().is_ok_and(|about| is_absent(run, &about));
    let is_decisive = |c: &Concern| c.weight == LARGEST_WEIGHT && c.stage != "report" && !is_absent(c);
    warnings(concerns).zip(1..).find(|(c, _)| is_decisive(c)).map(|(concern, number)| (number, concern.about.as_str()))
}

/// Whether a warning is about mass or speed that nobody stated.
fn is_absent(run: &Run, about: &About) -> bool {
    match about {
        About::Mass => run.test.mass_kg.is_none(),
        About::ImpactSpeed => run.test.impact_speed_m_per_s.is_none(),
        _ => false,
    }
}

/// Whether a warning is about what the test is: its pulse, mass, speed, time axis, or a motion that is not theirs. What
/// sensors differ in, and that two vehicles collided, is no fault of the record.
pub fn is_of_the_test(run: &Run, concern: &Concern) -> bool {
    let is_about =
        |about: &About| matches!(about, About::Pulse | About::Mass | About::ImpactSpeed | About::Time | About::Motion);
    concern.stage != "report" && concern.about.parse().is_ok_and(|about| is_about(&about) && !is_absent(run, &about))
}

/// The concerns of a run, weighed from 1 to `LARGEST_WEIGHT`: the diagnosis of a stage without a result, what the
/// results contradict each other in, then, gravest first, the warnings of the stages and what follows from the results
/// themselves. No two of the first `SHOWN_FIRST` concern the same thing where others
/// are as grave within one step of how much they change.
pub fn concerns(run: &Run, ranking: &Ranking, kind: Kind) -> Vec<Concern> {
    let weighed = |remark: &RemarkV1| Concern::new(remark, prominence(&subject(remark), run, ranking, kind));
    let of_stages = run
        .remarks
        .iter()
        .filter(|remark| remark.is_warning())
        .map(|remark| Concern { remedy: remark.remedy.clone().filter(|_| is_no_result(remark)), ..weighed(remark) });
    let own = own_remarks(run, ranking, kind)
        .into_iter()
        .map(|note| Concern { remedy: None, ..weighed(&RemarkV1::new("report", &note)) });
    let mut all: Vec<Concern> = of_stages.chain(own).collect();
    // Of another record nobody asks for the mass of a vehicle.
    let is_asked = |concern: &Concern| {
        let is_of_it = kind != Kind::InputOutput || !concern.about.parse().is_ok_and(|about| is_of_a_crash(&about));
        is_of_it && (concern.is_no_result() || !run.allowed.contains(&concern.code))
    };
    all.retain(is_asked);
    // The sort is stable: equals stay in the order of the stages.
    all.sort_by_key(|concern| (!concern.is_no_result(), std::cmp::Reverse(concern.weight), order_of(&concern.about)));
    let mut all = one_each_first(all);
    // What else is said follows from what contradicts itself.
    let of_contradiction = |remark: &RemarkV1| match &remark.written_by {
        Some(program) => Concern { text: format!("{}; written by {program}", remark.text), ..weighed(remark) },
        None => weighed(remark),
    };
    let contradictions = run.contradictions.iter().map(of_contradiction).filter(is_asked);
    let after_the_diagnoses = all.iter().take_while(|concern| concern.is_no_result()).count();
    all.splice(after_the_diagnoses..after_the_diagnoses, contradictions);
    all
}

/// All remarks of a run, strongest first; equals in the order of the concerns.
pub fn remarks(run: &Run, ranking: &Ranking, kind: Kind, concerns: &[Concern]) -> Vec<RemarkV1> {
    let own = own_remarks(run, ranking, kind);
    let own = own.iter().map(|note| RemarkV1::new("report", note));
    let all: Vec<RemarkV1> = run.contradictions.iter().chain(&run.remarks).cloned().chain(own).collect();
    let place = |remark: &RemarkV1| {
        let is_of = |concern: &Concern| {
            (&concern.stage, &concern.code) == (&remark.stage, &remark.code) && concern.text.starts_with(&remark.text)
        };
        concerns.iter().position(is_of).unwrap_or(concerns.len())
    };
    let mut all: Vec<(usize, RemarkV1)> = all.into_iter().map(|remark| (place(&remark), remark)).collect();
    all.sort_by_key(|(place, remark)| (std::cmp::Reverse(remark.weight), *place));
    all.into_iter().map(|(_, remark)| remark).collect()
}

/// Of the gravest ones those that concern different things come first.
fn one_each_first(all: Vec<Concern>) -> Vec<Concern> {
    let (mut first, mut others): (Vec<Concern>, Vec<Concern>) = (Vec::new(), Vec::new());
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

fn subject(remark: &RemarkV1) -> About {
    remark.about.parse().unwrap_or(About::Record)
}

/// The warnings of a run, which every surface counts alike: the diagnosis of a stage without a result is none.
pub fn warnings(concerns: &[Concern]) -> impl Iterator<Item = &Concern> {
    concerns.iter().filter(|concern| !concern.is_no_result())
}

/// Of the warnings in their order those for the first screen: at most `SHOWN_FIRST`, none that is said elsewhere, none
/// about what the screen does not show; and how many are left of all.
pub fn first_warnings<'a>(
    concerns: &'a [Concern],
    is_said: impl Fn(&Concern) -> bool,
    run: &Run,
    ranking: &Ranking,
) -> (Vec<&'a Concern>, usize) {
    let is_prominent = |concern: &&Concern| is_of_what_is_shown(concern, run, ranking);
    let own = warnings(concerns).filter(|concern| !is_said(concern));
    let first: Vec<&Concern> = own.filter(is_prominent).take(SHOWN_FIRST).collect();
    let others = warnings(concerns).count() - first.len();
    (first, others)
}

/// Whether the first screen shows what a warning is about: not another candidate, a method that failed, another
/// channel, occupants beside a vehicle, predictions where no model is recommended.
fn is_of_what_is_shown(concern: &Concern, run: &Run, ranking: &Ranking) -> bool {
    match concern.about.parse() {
        Ok(About::Method(_)) => false,
        Ok(About::Channel(id)) => run.channel_id() == Some(&id),
        Ok(About::Occupants) => kind_of(run) == Kind::Occupant,
        Ok(About::Predictions) => ranking.best.is_some(),
        Ok(about @ (About::Mass | About::ImpactSpeed)) => kind_of(run) != Kind::Recorder || !is_absent(run, &about),
        _ => !is_of_another_candidate(concern, run, ranking),
    }
}

/// The warnings that a list leaves out.
pub(crate) fn more_warnings(count: usize) -> String {
    if count == 1 { "1 more warning".to_owned() } else { format!("{count} more warnings") }
}

/// A remedy as a sentence.
pub(crate) fn what_to_do(remedy: &str) -> String {
    format!("What to do: {remedy}.")
}

/// Whether a concern says why an identification method gave no model: such concerns have a list of their own.
pub fn is_of_a_failed_method(concern: &Concern) -> bool {
    matches!(concern.about.parse(), Ok(About::Method(_)))
}

/// What only a crash has: of another record nobody asks for it.
fn is_of_a_crash(about: &About) -> bool {
    matches!(about, About::Pulse | About::Mass | About::ImpactSpeed | About::Motion)
}

/// Whether a concern is of a candidate that nobody recommends: neither for predictions, nor as the simplest or closest.
pub fn is_of_another_candidate(concern: &Concern, run: &Run, ranking: &Ranking) -> bool {
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
        // The table of a recorder has its own change of velocity; mass and speed add to it.
        About::Mass | About::ImpactSpeed if kind == Kind::Recorder && is_absent(run, about) => 1,
        About::Pulse | About::Mass | About::ImpactSpeed | About::Time | About::Motion => 3,
        About::Model(name) => prominence_of_model(name, run, ranking),
        About::Predictions | About::WallForce | About::Record => 2,
        About::Occupants => {
            if kind == Kind::Occupant {
                3
            } else {
                1
            }
        }
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

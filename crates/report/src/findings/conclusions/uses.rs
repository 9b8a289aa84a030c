//! Two questions on a run: is its record sound, and what are its answers good for?

use std::cmp::Reverse;
use std::collections::BTreeMap;

use crumple_signal::About;
use serde::{Deserialize, Serialize};

use crate::findings::conclusions::concerns::{Concern, is_of_the_test, warnings};
use crate::findings::conclusions::conclusion::Conclusion;
use crate::findings::conclusions::kind::{Kind, subject_of};
use crate::findings::conclusions::status::{
    WIDE_PERCENT, answer, answer_percent, has_only_forces, has_the_forces, of_identified,
};
use crate::findings::text::{listed, parameter, parameter_order};
use crate::findings::{CandidateResult, Ranking, Run};
use crate::words;

/// Whether the record is what it is taken for: the right channel, sign, unit, mass, speed and time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Soundness {
    /// Nothing speaks against it.
    Sound,
    /// A number may be off by more than its interval says.
    Check,
    /// It may be another thing than it is taken for.
    Wrong,
}

impl Soundness {
    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Sound => "sound",
            Self::Check => "check",
            Self::Wrong => "wrong",
        }
    }
}

/// Something that a run can be used for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[allow(missing_docs, reason = "fields are named after what they are")]
pub enum Use {
    /// Delta-v, peak and what else is read off the pulse.
    MeasuredQuantities,
    /// The dynamic crush at the impact speed of the test.
    CrushAtTheTestedSpeed,
    /// The crush at other speeds. `to_percent`: half width of its interval where it answers.
    OtherSpeeds { to_percent: f64 },
    /// Forces over deflection.
    Forces,
    /// Parameters of the recommended model whose interval is as narrow as that of a prediction that answers.
    Parameters {
        #[serde(default)]
        names: Vec<String>,
    },
    /// Criteria of an occupant.
    OccupantCriteria,
    /// Frequencies and damping ratios of an identified model.
    IdentifiedModes,
}

impl Use {
    /// In words: `other speeds to ±6 %`.
    pub fn in_words(&self) -> String {
        let words = match self {
            Self::MeasuredQuantities => "measured quantities",
            Self::CrushAtTheTestedSpeed => "crush at the tested speed",
            Self::OtherSpeeds { to_percent } => {
                return format!("other speeds to ±{}", words::quantity(*to_percent, 0, "%"));
            }
            Self::Forces => "forces",
            Self::Parameters { names } => {
                let symbols: Vec<String> = names.iter().map(|name| parameter("", name, 0.0).0).collect();
                return listed(&symbols);
            }
            Self::OccupantCriteria => "criteria of the occupant",
            Self::IdentifiedModes => "frequencies and damping",
        };
        words.to_owned()
    }
}

impl Conclusion {
    /// The two questions on a run, each with its answer: is the record sound, and what is the answer good for. Nothing
    /// where an earlier version did not say it.
    pub fn answers(&self) -> impl Iterator<Item = (&'static str, String)> {
        let of_record = self.record.map(|record| match self.record_about.as_deref() {
            Some(about) => ("record", format!("{}: {}", record.word(), subject_of(about))),
            None => ("record", record.word().to_owned()),
        });
        of_record.map(|of_record| [of_record, ("good for", self.uses())]).into_iter().flatten()
    }

    /// `measured quantities, crush at the tested speed, other speeds to ±6 %`.
    pub fn uses(&self) -> String {
        let uses: Vec<String> = self.good_for.iter().map(Use::in_words).collect();
        if uses.is_empty() { "nothing".to_owned() } else { uses.join(", ") }
    }
}

/// Weights of concerns of the record, which the first screen shows: three times those of remarks.
pub const MARKED: u8 = 6;
const DECISIVE: u8 = 9;

/// Whether the record is sound, by the gravest warning about what the test is, and what that warning is about where it
/// is not. What programs contradict each other in is no fault of the record, and that a sensor sits in an occupant is
/// known of a record of one.
pub fn soundness<'a>(run: &Run, kind: Kind, concerns: &'a [Concern]) -> (Soundness, Option<&'a str>) {
    let is_contradiction = |concern: &Concern| run.contradictions.iter().any(|found| found.code == concern.code);
    let is_of_place = |concern: &Concern| kind == Kind::Occupant && concern.about.parse() == Ok(About::Pulse);
    let about_the_test = warnings(concerns)
        .filter(|concern| is_of_the_test(run, concern) && !is_contradiction(concern) && !is_of_place(concern));
    // The first of the gravest.
    let gravest = about_the_test.min_by_key(|concern| Reverse(concern.weight));
    match gravest.map(|concern| (concern.weight, concern.about.as_str())) {
        Some((DECISIVE.., about)) => (Soundness::Wrong, Some(about)),
        Some((MARKED.., about)) => (Soundness::Check, Some(about)),
        _ => (Soundness::Sound, None),
    }
}

/// What the answers of a run are good for, in the order in which they depend on each other. Empty: for nothing.
pub fn good_for(run: &Run, ranking: &Ranking, kind: Kind, concerns: &[Concern]) -> Vec<Use> {
    let in_doubt = |what: &[About]| {
        let is_of = |concern: &&Concern| concern.about.parse().is_ok_and(|about| what.contains(&about));
        let decisive = warnings(concerns).filter(|c| c.weight >= DECISIVE && is_of_the_test(run, c));
        decisive.into_iter().any(|concern| is_of(&concern))
    };
    match kind {
        Kind::Occupant => {
            let is_against = |concern: &&Concern| {
                matches!(concern.about.parse(), Ok(About::Occupants | About::Time)) && concern.weight >= DECISIVE
            };
            let is_open = warnings(concerns).find(is_against).is_none();
            return is_open.then_some(Use::OccupantCriteria).into_iter().collect();
        }
        Kind::InputOutput => return of_identified(run).is_none().then_some(Use::IdentifiedModes).into_iter().collect(),
        _ => {}
    }
    let is_measured = run.channel().is_some() && !in_doubt(&[About::Pulse, About::Time]);
    if kind != Kind::SeveralTests && !is_measured {
        return Vec::new();
    }
    let mut uses = Vec::new();
    if kind != Kind::SeveralTests {
        uses.push(Use::MeasuredQuantities);
    }
    let is_known_speed = !in_doubt(&[About::ImpactSpeed, About::Motion]);
    let has_crush = run.events.as_ref().is_some_and(|events| events.dynamic_crush_m.is_some());
    if kind == Kind::Barrier && has_crush && is_known_speed && run.other_axis().is_none() {
        uses.push(Use::CrushAtTheTestedSpeed);
    }
    let best = ranking.best.as_deref().and_then(|id| run.candidate(id));
    if let Some(best) = best.filter(|_| is_known_speed && kind != Kind::TwoVehicles && !in_doubt(&[About::Mass])) {
        // What contradicts about the model, and tests that it misses, take its answers away.
        let is_against = |concern: &&Concern| match concern.about.parse() {
            Ok(About::Model(name)) => concern.stage != "report" && name == best.id && concern.weight >= DECISIVE,
            Ok(About::Predictions) => concern.weight >= MARKED,
            _ => false,
        };
        if warnings(concerns).find(is_against).is_none() {
            uses.extend(of_model(run, best));
        }
    }
    uses
}

/// What a recommended model is good for.
fn of_model(run: &Run, best: &CandidateResult) -> Vec<Use> {
    let mut uses = Vec::new();
    let percent = answer(run, best).and_then(|(_, prediction)| answer_percent(prediction));
    let is_adequate = run.rated(&best.id).is_none_or(|rated| rated.adequate);
    if let Some(to_percent) = percent.filter(|percent| *percent <= WIDE_PERCENT) {
        uses.push(Use::OtherSpeeds { to_percent });
    }
    let known = best.certainties();
    let is_determined = known.determined == known.parameters && best.record.uncertainty.is_some();
    if is_adequate && has_only_forces(best) && (is_determined || has_the_forces(run, best)) {
        uses.push(Use::Forces);
    }
    let names = if is_adequate && !has_only_forces(best) { narrow(best) } else { Vec::new() };
    if !names.is_empty() && best.record.equivalent_to.is_none() {
        uses.push(Use::Parameters { names });
    }
    uses
}

/// Parameters that were asked of the record and whose 95 % interval is at most [`WIDE_PERCENT`] wide to each side, in
/// the order in which people write them.
fn narrow(best: &CandidateResult) -> Vec<String> {
    let Some(known) = &best.record.uncertainty else { return Vec::new() };
    let end = |ends: &BTreeMap<String, Option<f64>>, name: &str| ends.get(name).copied().flatten();
    let is_narrow = |name: &&str| {
        let ends = end(&known.interval_low, name).zip(end(&known.interval_high, name));
        let value = best.record.parameters.get(*name);
        let share = ends.zip(value).map(|((low, high), value)| (value - low).max(high - value) / value.abs());
        share.is_some_and(|share| 100.0 * share <= WIDE_PERCENT)
    };
    let mut names: Vec<&str> = best.record.asked().filter(is_narrow).collect();
    names.sort_by_key(|name| parameter_order(&best.record.model, name));
    names.into_iter().map(str::to_owned).collect()
}

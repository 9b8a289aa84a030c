//! Whether the results of a run may be used: one word and its one reason, both decided from records.

use crumple_artifact::records::{PredictedIntervalV1, PredictionV1, StrengthV1};
use crumple_lumped::{ParameterKind, parameter_kind};
use serde::{Deserialize, Serialize};

use crate::findings::conclusions::concerns::{Concern, decisive_warning, is_of_the_test, warnings};
use crate::findings::conclusions::key_numbers::{KeyNumber, key_numbers};
use crate::findings::conclusions::kind::{Kind, lacks_mass_or_speed};
use crate::findings::conclusions::uses::{MARKED, Soundness, soundness};
use crate::findings::{CandidateResult, Model, Ranking, Run};

/// Largest half width of the interval of a predicted crush of which nothing has to be said, percent of the crush.
const NARROW_PERCENT: f64 = 10.0;
/// Half width of such an interval above which the prediction answers nothing, percent of the crush.
pub const WIDE_PERCENT: f64 = 30.0;

/// A half width in percent as it is said: rounded, but never to a limit that it is beyond.
fn said_percent(half_width: f64) -> f64 {
    let nearest = half_width.round();
    if [0.0, NARROW_PERCENT, WIDE_PERCENT].contains(&nearest) { half_width.ceil() } else { nearest }
}

/// One word on the results of a run, the better one less.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Of an adequate model whose prediction is known to 10 %.
    Usable,
    /// For what the reason says.
    UsableWithCare,
    /// The record is wrong, or what was asked for has no answer.
    DoNotUse,
}

impl Status {
    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Usable => "usable",
            Self::UsableWithCare => "usable with care",
            Self::DoNotUse => "do not use",
        }
    }

    /// Its word with the reason.
    pub(crate) fn sentence(self, because: &str) -> String {
        format!("{}: {because}.", self.word())
    }
}

/// The one reason of a status: what limits the results most. Numbers in SI; percentages of the value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[allow(missing_docs, reason = "fields are named after what they are")]
pub enum StatusReason {
    /// The half width of the interval of the crush that is predicted, in percent as said. `prediction`: place among
    /// those of the summary, of what was asked for (`asked`), else of the slowest impact inside the test.
    GoodTo {
        good_to_percent: f64,
        prediction: usize,
        #[serde(default)]
        asked: bool,
    },
    /// The same of an impact beyond the test.
    Beyond {
        good_to_percent: f64,
        prediction: usize,
        #[serde(default)]
        asked: bool,
    },
    /// Sensors of the compartment are further from the pulse's crush than its interval.
    SensorsDiffer {
        sensors: usize,
        apart_m: f64,
        #[serde(default)]
        low_m: f64,
        #[serde(default)]
        high_m: f64,
        half_width_m: f64,
    },
    /// The record does not determine all numbers of the recommended model.
    FewDetermined {
        determined: usize,
        parameters: usize,
        are_forces: bool,
    },
    /// The recommended model misses these events of its own test, so that it is not adequate: its crush alone is right.
    MissesItsTest {
        events: Vec<String>,
    },
    /// Another model fits nearly as well: its candidate.
    Weak {
        candidate: String,
    },
    /// Another model follows the pulse closer, but not the crush at lower speeds: its candidate.
    Contrary {
        candidate: String,
    },
    /// Nobody says how well the parameters of the recommended model are known.
    Unassessed,
    /// The recommended model has a dual.
    Dual,
    /// No prediction of the recommended model has an interval of its crush.
    NoInterval,
    /// A test lies outside of what the model of the others predicts for it.
    TestsDisagree,
    /// The vehicle did not stop within the record.
    NoStop,
    /// The pulse is not along x.
    OtherAxis {
        axis: String,
    },
    /// Two vehicles collided.
    TwoVehicles,
    /// The sensor sits in an occupant.
    Occupant,
    /// The table of an event data recorder.
    Recorder,
    /// A model of inputs and outputs.
    Identified,
    /// Mass, impact speed or both are not stated.
    NoMass,
    NoSpeed,
    NoMassNorSpeed,
    /// The stages of motion or models did not run.
    MeasuredOnly,
    /// There are adequate models, none of them for other speeds.
    NoneRecommended,
    /// There is no acceptable result.
    NoResult,
    /// The warning of this number, counted from 1, puts everything in doubt. `about`: as in `concerns`.
    DecisiveWarning {
        number: usize,
        about: String,
    },
    /// The warning of this number, counted from 1, asks to check what the test is. `about`: as in `concerns`.
    Check {
        number: usize,
        about: String,
    },
    /// No identified model describes the record.
    NotAdequate,
    /// No model of the crash describes it; what was measured holds.
    NoneAdequate,
    /// The best model has a fit below the limit, percent.
    PoorFit {
        fit_percent: f64,
        limit_percent: f64,
    },
}

impl StatusReason {
    /// The word that it is the reason of.
    pub fn status(&self) -> Status {
        match self {
            Self::GoodTo { good_to_percent, .. } if *good_to_percent <= NARROW_PERCENT => Status::Usable,
            // What was measured holds; what was asked for is not answered.
            Self::GoodTo { good_to_percent, asked: true, .. } | Self::Beyond { good_to_percent, asked: true, .. }
                if *good_to_percent > WIDE_PERCENT =>
            {
                Status::DoNotUse
            }
            Self::NoResult | Self::DecisiveWarning { .. } | Self::NotAdequate | Self::PoorFit { .. } => {
                Status::DoNotUse
            }
            _ => Status::UsableWithCare,
        }
    }
}

/// The reason of the status of a run: what limits its answers, else what of its record is to be checked.
pub fn status_reason(run: &Run, ranking: &Ranking, kind: Kind, concerns: &[Concern]) -> StatusReason {
    let reason = reason_of_answers(run, ranking, kind, concerns);
    if reason.status() != Status::Usable || soundness(run, kind, concerns).0 == Soundness::Sound {
        return reason;
    }
    let marked =
        warnings(concerns).zip(1..).find(|(concern, _)| is_of_the_test(run, concern) && concern.weight >= MARKED);
    marked.map_or(reason, |(concern, number)| StatusReason::Check { number, about: concern.about.clone() })
}

fn reason_of_answers(run: &Run, ranking: &Ranking, kind: Kind, concerns: &[Concern]) -> StatusReason {
    use StatusReason as Reason;
    match kind {
        Kind::NoModel => return Reason::NoResult,
        // That it is no sensor of the vehicle is the decisive warning of such a record.
        Kind::Occupant => return Reason::Occupant,
        _ => {}
    }
    if let Some((number, about)) = decisive_warning(run, concerns) {
        return Reason::DecisiveWarning { number, about: about.to_owned() };
    }
    match kind {
        Kind::InputOutput => of_identified(run).unwrap_or(Reason::Identified),
        Kind::Recorder => Reason::Recorder,
        _ if kind == Kind::LinearModel || lacks_mass_or_speed(run) => {
            match (run.test.mass_kg, run.test.impact_speed_m_per_s) {
                (None, None) => Reason::NoMassNorSpeed,
                (None, Some(_)) => Reason::NoMass,
                _ => Reason::NoSpeed,
            }
        }
        Kind::TwoVehicles => Reason::TwoVehicles,
        Kind::NoStop => Reason::NoStop,
        _ => of_models(run, ranking, kind),
    }
}

/// An identified model that follows less of its record than this, percent, describes none.
const HALF_PERCENT: f64 = 50.0;

/// Returns the reason when not even the closest identified model has a fit, follows half of the record, or holds on
/// unseen samples.
pub fn of_identified(run: &Run) -> Option<StatusReason> {
    if let Some(ambient) = run.ambient() {
        return ambient.clusters.is_empty().then_some(StatusReason::NotAdequate);
    }
    let Some((_, model, fit_percent)) = closest_identified(run) else { return Some(StatusReason::NotAdequate) };
    if !model.holds() {
        return Some(StatusReason::NotAdequate);
    }
    let limit_percent = HALF_PERCENT;
    (fit_percent < limit_percent).then_some(StatusReason::PoorFit { fit_percent, limit_percent })
}

/// The identified model to speak of, see [`Run::model_order`]: its place, itself, the fit in percent.
pub(crate) fn closest_identified(run: &Run) -> Option<(usize, &Model, f64)> {
    let models = run.model_order().into_iter().map(|k| (k, &run.models[k]));
    models.into_iter().find_map(|(k, model)| Some((k, model, model.fit_percent()?)))
}

/// The reason of the status of a crash whose models were asked for.
fn of_models(run: &Run, ranking: &Ranking, kind: Kind) -> StatusReason {
    use StatusReason as Reason;
    if run.candidates.is_empty() && run.joint.is_none() {
        return Reason::MeasuredOnly;
    }
    let Some(best) = ranking.best.as_deref().and_then(|id| run.candidate(id)) else {
        if let Some(axis) = run.other_axis().filter(|_| kind != Kind::SeveralTests) {
            return Reason::OtherAxis { axis: axis.to_string() };
        }
        let is_adequate = run.recommendation.iter().flat_map(|choice| &choice.candidates).any(|rated| rated.adequate);
        return if is_adequate { Reason::NoneRecommended } else { Reason::NoneAdequate };
    };
    let answer = answer(run, best);
    let good_to_percent = answer.and_then(|(_, prediction)| answer_percent(prediction));
    let good_to = answer.zip(good_to_percent).map(|((prediction, record), good_to_percent)| {
        let asked = record.asked;
        match record.extrapolates {
            true => Reason::Beyond { good_to_percent, prediction, asked },
            false => Reason::GoodTo { good_to_percent, prediction, asked },
        }
    });
    let is_limit = |reason: &Reason| reason.status() != Status::Usable;
    let asked = good_to.clone().filter(|_| answer.is_some_and(|(_, prediction)| prediction.asked));
    let disagree = run.joint.as_ref().filter(|joint| !joint.missed().is_empty()).map(|_| Reason::TestsDisagree);
    disagree
        .or_else(|| asked.filter(is_limit))
        .or_else(|| misses_its_test(run, best))
        .or_else(|| sensors_differ(run))
        .or_else(|| uncertain(run, best))
        .or_else(|| beside(run))
        .or(good_to)
        .unwrap_or(Reason::NoInterval)
}

/// Returns the reason when the recommended model is right in its crush alone.
fn misses_its_test(run: &Run, best: &CandidateResult) -> Option<StatusReason> {
    let events = run.rated(&best.id).filter(|rated| !rated.adequate)?.missed_events.clone();
    (!events.is_empty()).then_some(StatusReason::MissesItsTest { events })
}

/// Returns the reason when the evidence is not decisive for the recommended model beside the best other one.
pub(crate) fn beside(run: &Run) -> Option<StatusReason> {
    let choice = run.recommendation.as_ref()?;
    let candidate = choice.beside.clone()?;
    match choice.strength? {
        StrengthV1::Weak => Some(StatusReason::Weak { candidate }),
        // Said of two misfits that were computed alone.
        StrengthV1::Contrary => {
            let misfit = |id: &str| run.rated(id)?.misfit.filter(|misfit| misfit.is_finite());
            let (other, own) = misfit(&candidate).zip(misfit(choice.recommended.as_deref()?))?;
            (other < own).then_some(StatusReason::Contrary { candidate })
        }
        StrengthV1::Decisive => None,
    }
}

/// Returns the reason when parameters of a model are not known. Forces of a curve are known together, though none of
/// them may be known beside the others, where the curve has the decelerations of the record.
fn uncertain(run: &Run, best: &CandidateResult) -> Option<StatusReason> {
    let (known, are_forces) = (best.certainties(), has_only_forces(best));
    if known.determined < known.parameters && !(are_forces && has_the_forces(run, best)) {
        let (determined, parameters) = (known.determined, known.parameters);
        return Some(StatusReason::FewDetermined { determined, parameters, are_forces });
    }
    if best.record.uncertainty.is_none() && !best.is_chain() {
        return Some(StatusReason::Unassessed);
    }
    best.record.equivalent_to.as_ref().map(|_| StatusReason::Dual)
}

/// Root mean square misfit of the deceleration over its mean up to which a curve has the forces of the record: what is
/// asked of forces that are within 15 %.
const OF_THE_MEAN: f64 = 0.15;

/// Whether a model misses the decelerations of the record by little beside their mean, `v0²/2C`.
pub fn has_the_forces(run: &Run, best: &CandidateResult) -> bool {
    let Some(events) = &run.events else { return false };
    let mean = events.impact_speed_m_per_s.zip(events.dynamic_crush_m).map(|(v0, crush)| 0.5 * v0 * v0 / crush);
    let choice = run.recommendation.as_ref().and_then(|choice| choice.evidence.as_ref());
    let is_of_accelerations = choice.is_some_and(|evidence| evidence.quantity == "acceleration");
    let misfit = run.rated(&best.id).and_then(|rated| rated.misfit).filter(|_| is_of_accelerations);
    misfit.zip(mean).is_some_and(|(misfit, mean)| misfit <= OF_THE_MEAN * mean)
}

/// Whether forces at deflections are all that was asked of the record.
pub(crate) fn has_only_forces(candidate: &CandidateResult) -> bool {
    candidate.record.asked().all(|name| {
        name.starts_with("knot") && parameter_kind(&candidate.record.model, name) == Some(ParameterKind::Force)
    })
}

/// Returns the reason when the interval of the crush misses another sensor of the place.
fn sensors_differ(run: &Run) -> Option<StatusReason> {
    let crush = key_numbers(run).into_iter().find(|number| number.name == "dynamic_crush")?;
    let KeyNumber { value: Some(value), low: Some(low), high: Some(high), spread: Some(spread), .. } =
        Some(crush).filter(KeyNumber::interval_misses_a_sensor)?
    else {
        return None;
    };
    Some(StatusReason::SensorsDiffer {
        sensors: spread.sensors(),
        apart_m: (value - spread.low).max(spread.high - value),
        low_m: spread.low,
        high_m: spread.high,
        half_width_m: 0.5 * (high - low),
    })
}

/// What a recommended model says of the impact that was asked for: with its place among the predictions. One that was
/// asked for goes before others, one inside the test before one beyond it, the slowest before faster ones. `None`: it
/// predicts no crush.
pub(crate) fn answer<'a>(run: &'a Run, best: &CandidateResult) -> Option<(usize, &'a PredictionV1)> {
    let order = |p: &PredictionV1| (!p.asked, p.extrapolates);
    let of_best = run.predictions.iter().enumerate().filter(|(_, p)| p.candidate == best.id);
    of_best.filter(|(_, p)| p.dynamic_crush_m.is_some()).min_by(|(_, a), (_, b)| {
        order(a).cmp(&order(b)).then(a.impact_speed_m_per_s.total_cmp(&b.impact_speed_m_per_s))
    })
}

/// The interval of a predicted crush, with its place among the intervals.
pub(crate) fn interval_of_crush(prediction: &PredictionV1) -> Option<(usize, &PredictedIntervalV1)> {
    prediction.intervals.iter().enumerate().find(|(_, interval)| interval.name == "dynamic_crush_m")
}

/// Half of the width of the interval of a predicted crush, percent of it as said.
pub fn answer_percent(prediction: &PredictionV1) -> Option<f64> {
    half_width_percent(prediction).map(said_percent)
}

/// Half of the width of the interval of a predicted crush, percent of it.
fn half_width_percent(prediction: &PredictionV1) -> Option<f64> {
    let crush_m = prediction.dynamic_crush_m.filter(|crush_m| *crush_m > 0.0)?;
    let (_, interval) = interval_of_crush(prediction)?;
    Some(50.0 * (interval.high - interval.low) / crush_m)
}

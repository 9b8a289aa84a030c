//! The result of a run in a word and a few sentences, made by rules from its records.

use crate::drawing::numbers::{KM_PER_H_PER_M_PER_S, MILLI};
use crate::words;
use crumple_artifact::records::{EventsV1, MetricV1, PredictionV1};
use crumple_signal::About;
use crumple_signal::display::factor_shown;
use crumple_signal::key_quantities::{CRUSH, DELTA_V, OLC, PEAK, STIFFNESS, STROKE};
use serde::{Deserialize, Deserializer, Serialize};

use crate::findings::conclusions::concerns::{Concern, concerns, what_to_do};
use crate::findings::conclusions::key_numbers::{bound_of_change, in_ms};
use crate::findings::conclusions::kind::{Kind, ResultStatus, kind_of, lacks_mass_or_speed, not_stated, subject_of};
use crate::findings::conclusions::several_tests::{missed, several_tests};
use crate::findings::conclusions::status::{
    Status, StatusReason, answer, beside, closest_identified, has_only_forces, interval_of_crush, status_reason,
};
use crate::findings::conclusions::uses::{Soundness, Use, good_for, soundness};
use crate::findings::results::ranking::none_recommended;
use crate::findings::results::run::not_determined;
use crate::findings::text::{DEFLECTION, as_sentence, deflection_of_knot, listed, symbols};
use crate::findings::{CandidateResult, OneSpring, Ranking, Run};

/// How a number is shown: factor to its unit, decimals, unit.
type Shown = (f64, usize, &'static str);

/// How counts are shown: factor, decimals, unit.
const COUNT: (f64, usize, &str) = (1.0, 0, "");
/// How whole percentages are shown.
const PERCENT: (f64, usize, &str) = (1.0, 0, "%");
/// How fits are shown.
pub(super) const FIT: (f64, usize, &str) = (1.0, 1, "%");

/// Where there is no motion to speak of.
const NO_MOTION: &str = "This report holds no motion of a vehicle.";

/// A number of the sentences and where `summary.json` has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct Number {
    /// JSON pointer into the summary.
    pub at: String,
    /// The value there.
    pub value: f64,
    /// What is shown of it.
    pub shown: String,
}

/// Reads a value; one that is not known, of another version, is its default.
fn known<'de, T: Default + serde::de::DeserializeOwned, D: Deserializer<'de>>(reader: D) -> Result<T, D::Error> {
    Ok(serde_json::from_value(serde_json::Value::deserialize(reader)?).unwrap_or_default())
}

/// The verdict.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(default)]
#[cfg_attr(feature = "schemas", schemars(!default))]
pub struct Conclusion {
    /// What kind of record it is about.
    #[serde(deserialize_with = "known")]
    pub kind: Kind,
    /// Whether there is what was asked for.
    #[serde(deserialize_with = "known")]
    pub standing: ResultStatus,
    /// Whether the results may be used; `None`: an early version did not say it.
    #[cfg_attr(feature = "schemas", schemars(with = "Status"))]
    pub status: Option<Status>,
    /// Whether the record is sound; `None`: an earlier version did not say it.
    #[cfg_attr(feature = "schemas", schemars(with = "Soundness"))]
    pub record: Option<Soundness>,
    /// What the warning is about that says it is not, as in `concerns`; `None`: it is sound, or an earlier version did
    /// not say it.
    pub record_about: Option<String>,
    /// What the answers are good for.
    pub good_for: Vec<Use>,
    /// Its one reason, typed.
    #[serde(deserialize_with = "known")]
    #[cfg_attr(feature = "schemas", schemars(with = "StatusReason"))]
    pub status_reason: Option<StatusReason>,
    /// The reason in words.
    #[serde(skip)]
    pub because: String,
    /// Both in words: `usable with care: the crush at 40 km/h is predicted to ±16 %.`
    pub status_sentence: String,
    /// What happened; which model, what it gives, what it does not.
    pub sentences: Vec<String>,
    /// The numbers in them.
    pub numbers: Vec<Number>,
    /// Numbers of the recommended model that were asked of the record, and how many of them it determines.
    pub parameters: Option<usize>,
    /// How many of them it determines.
    pub determined: Option<usize>,
    /// How many of the others are known to an order of magnitude.
    pub order_of_magnitude: Option<usize>,
    /// How many may be anything.
    pub open: Option<usize>,
    /// Why there is no result.
    pub reason: Option<String>,
    /// What to do for one.
    pub remedy: Option<String>,
}

impl Conclusion {
    /// Whether the impact speed is in doubt, and with it what follows from it.
    pub fn is_speed_in_doubt(&self) -> bool {
        self.status_reason.as_ref().is_some_and(is_speed_in_doubt)
    }

    /// How many numbers of the recommended model are determined, rough, open: `3 of 5 determined, 2 open`.
    pub(crate) fn certainty(&self) -> Option<String> {
        let (determined, parameters) = (self.determined?, self.parameters?);
        let others = not_determined(self.order_of_magnitude.unwrap_or(0), self.open.unwrap_or(0));
        Some(format!("{determined} of {parameters} determined{others}"))
    }
}

/// The verdict on a run and its concerns.
pub fn conclusion(run: &Run, ranking: &Ranking) -> (Conclusion, Vec<Concern>) {
    let kind = kind_of(run);
    let concerns = concerns(run, ranking, kind);
    let mut text = Text { run, ranking, numbers: Vec::new() };
    let reason = status_reason(run, ranking, kind, &concerns);
    let because = text.because(&reason);
    let sentences = text.sentences(kind, &reason, &concerns);
    let diagnosis = concerns.iter().find(|concern| concern.is_no_result());
    let best = text.best();
    let standing = match kind {
        Kind::NoModel => ResultStatus::NoResult,
        _ if best.is_some() || matches!(kind, Kind::InputOutput | Kind::LinearModel) => ResultStatus::Model,
        _ => ResultStatus::NoneRecommended,
    };
    let (record, record_about) = soundness(run, kind, &concerns);
    let verdict = Conclusion {
        kind,
        standing,
        status: Some(reason.status()),
        record: Some(record),
        record_about: record_about.map(str::to_owned),
        good_for: good_for(run, ranking, kind, &concerns),
        status_sentence: reason.status().sentence(&because),
        status_reason: Some(reason),
        because,
        sentences,
        numbers: text.numbers,
        parameters: best.map(|best| best.certainties().parameters),
        determined: best.map(|best| best.certainties().determined),
        order_of_magnitude: best.map(|best| best.certainties().order_of_magnitude.len()),
        open: best.map(|best| best.certainties().open.len()),
        reason: diagnosis.map(|concern| concern.text.clone()),
        remedy: diagnosis.and_then(|concern| concern.remedy.clone()),
    };
    (verdict, concerns)
}

/// Text on its way, with the numbers it has taken.
pub(super) struct Text<'a> {
    pub(super) run: &'a Run,
    ranking: &'a Ranking,
    numbers: Vec<Number>,
}

impl<'a> Text<'a> {
    /// A number of the summary, shown by `factor`, so many decimals and the unit.
    pub(super) fn number(
        &mut self,
        at: &str,
        value: f64,
        (factor, places, unit): (f64, usize, &'static str),
    ) -> String {
        let shown = words::quantity(factor * value, places, unit);
        self.numbers.push(Number { at: at.to_owned(), value, shown: shown.clone() });
        shown
    }

    /// `the crush at 40 km/h is predicted to ±16 %`.
    fn because(&mut self, reason: &StatusReason) -> String {
        use StatusReason as Reason;
        const REASON: &str = "/verdict/status_reason";
        let at = |name: &str| format!("{REASON}/{name}");
        match reason {
            Reason::GoodTo { good_to_percent, prediction, .. } => {
                let good_to = self.number(&at("good_to_percent"), *good_to_percent, PERCENT);
                format!("the crush {} is predicted to ±{good_to}", self.scenario(*prediction))
            }
            Reason::Beyond { good_to_percent, prediction, .. } => {
                let good_to = self.number(&at("good_to_percent"), *good_to_percent, PERCENT);
                let scenario = self.scenario(*prediction);
                format!("{scenario}, beyond the test, the crush is predicted to ±{good_to}")
            }
            Reason::SensorsDiffer { sensors, low_m, high_m, half_width_m, .. } => {
                let (factor, places, _) = CRUSH.shown();
                let low = self.number(&at("low_m"), *low_m, (factor, places, ""));
                let high = self.number(&at("high_m"), *high_m, CRUSH.shown());
                let half_width = self.number(&at("half_width_m"), *half_width_m, CRUSH.shown());
                let count = self.number(&at("sensors"), *sensors as f64, COUNT);
                format!(
                    "{count} sensors of the compartment read {low} to {high} of crush; a single one is good to \
                     ±{half_width}"
                )
            }
            Reason::FewDetermined { determined, parameters, are_forces } => {
                self.few_determined(REASON, [*determined, *parameters], *are_forces)
            }
            Reason::DecisiveWarning { number, about } => {
                let number = self.number(&at("number"), *number as f64, COUNT);
                format!("{} is in doubt, see warning {number}", subject_of(about))
            }
            Reason::Check { number, about } => {
                let number = self.number(&at("number"), *number as f64, COUNT);
                format!("check {}, see warning {number}", subject_of(about))
            }
            Reason::PoorFit { fit_percent, limit_percent } => {
                let fit = self.number(&at("fit_percent"), *fit_percent, FIT);
                let limit = self.number(&at("limit_percent"), *limit_percent, PERCENT);
                format!("the fit of the best model is {fit}, below {limit}")
            }
            Reason::MissesItsTest { events } => {
                let names: Vec<String> = events.iter().map(|name| words::metric(name)).collect();
                format!("use its crush only: the model misses the {} of its own test", listed(&names))
            }
            Reason::Weak { candidate } => {
                format!("the evidence is weak: {} fits nearly as well", self.run.name_of(candidate))
            }
            Reason::Contrary { candidate } => {
                let model = self.run.name_of(candidate);
                format!("chosen for its crush at lower speeds: {model} follows the pulse closer")
            }
            Reason::OtherAxis { axis } => {
                format!("use its delta-v: the pulse is along {axis}, the models are of a crush along x")
            }
            Reason::Unassessed => "the parameters of the model have no intervals".into(),
            Reason::Dual => "use its crush, not its mass split: one sensor cannot identify the split".into(),
            Reason::NoInterval => "the crush at other speeds has no interval".into(),
            Reason::TestsDisagree => "the tests disagree".into(),
            Reason::NoStop => format!("use its delta-v: the {} did not stop within the record", self.run.test.noun()),
            Reason::TwoVehicles => "use its delta-v: its motion over ground is not its crush".into(),
            Reason::Occupant => "use the criteria of the occupant, nothing for the vehicle".into(),
            Reason::Recorder => "use its delta-v, not its forces: the table is coarse".into(),
            Reason::Identified => "for the amplitudes and frequencies that this record excited".into(),
            Reason::NoMass => "no mass is stated: use the motion".into(),
            Reason::NoSpeed => "no impact speed is stated: use delta-v and pulse".into(),
            Reason::NoMassNorSpeed => "neither mass nor impact speed is stated: use delta-v and pulse".into(),
            Reason::MeasuredOnly => "use what was measured: no model was fitted".into(),
            Reason::NoneRecommended => "use what was measured: no model is for other speeds".into(),
            Reason::NoResult => "there is no acceptable result".into(),
            Reason::NotAdequate => "no model is adequate".into(),
            Reason::NoneAdequate => "use what was measured: no model is adequate".into(),
        }
    }

    /// How many of the parameters of a model are determined, with the numbers at `at`.
    fn few_determined(&mut self, at: &str, [determined, parameters]: [usize; 2], are_forces: bool) -> String {
        let of = self.number(&format!("{at}/determined"), determined as f64, COUNT);
        let all = self.number(&format!("{at}/parameters"), parameters as f64, COUNT);
        let (what, are) = (if are_forces { "forces" } else { "parameters" }, words::verb(determined));
        format!("use its crush, not its {what}: {of} of {all} {are} determined")
    }

    /// `at 40 km/h with 2000 kg against mpdb`: the mass where it is not that of the test.
    fn scenario(&mut self, place: usize) -> String {
        let Some(prediction) = self.run.predictions.get(place) else { return String::new() };
        let PredictionV1 { impact_speed_m_per_s, mass_kg, partner, .. } = prediction;
        let speed = self.speed(&format!("/predictions/{place}/impact_speed_m_per_s"), *impact_speed_m_per_s);
        let mass = (!self.run.is_of_own_mass(prediction))
            .then(|| self.number(&format!("/predictions/{place}/mass_kg"), *mass_kg, (1.0, 0, "kg")));
        format!("at {speed}{}", with_mass_against(mass, partner.as_deref()))
    }

    /// A speed, with a decimal where it has one.
    fn speed(&mut self, at: &str, speed_m_per_s: f64) -> String {
        let shown = factor_shown("km/h") * KM_PER_H_PER_M_PER_S * speed_m_per_s;
        let places = usize::from((shown - shown.round()).abs() >= 0.05);
        self.number(at, speed_m_per_s, (KM_PER_H_PER_M_PER_S, places, "km/h"))
    }

    fn sentences(&mut self, kind: Kind, reason: &StatusReason, concerns: &[Concern]) -> Vec<String> {
        match kind {
            Kind::NoModel => {
                let diagnosis = concerns.iter().find(|concern| concern.is_no_result());
                let reason = diagnosis.map_or("", |concern| concern.text.as_str());
                let remedy = diagnosis.and_then(|concern| concern.remedy.as_deref());
                let remedy = remedy.unwrap_or("the notes of the run say more, and its folder");
                vec![format!("There is no model: {reason}."), what_to_do(remedy)]
            }
            Kind::InputOutput => {
                let is_bad = reason.status() == Status::DoNotUse && closest_identified(self.run).is_some();
                let no_use = "Do not use it: its modes are not known to be those of what was measured.";
                std::iter::once(self.identified()).chain(is_bad.then(|| no_use.to_owned())).collect()
            }
            Kind::Occupant => vec![self.occupant(), self.occupant_use(concerns)],
            Kind::Recorder => {
                let energy = self.recorder_energy();
                [Some(self.recorded()), energy, Some(self.recorder_use())].into_iter().flatten().collect()
            }
            _ => {
                let happened = match kind {
                    // The way of a pulse along another axis is no crush.
                    Kind::Barrier if self.run.other_axis().is_none() => self.crushed(is_speed_in_doubt(reason)),
                    Kind::NoStop => self.no_stop(),
                    Kind::TwoVehicles => self.two_vehicles(),
                    Kind::SeveralTests => self.run.joint.as_ref().map_or_else(String::new, several_tests),
                    _ => self.changed().unwrap_or_else(|| NO_MOTION.to_owned()),
                };
                let mut sentences = vec![happened];
                sentences.extend(self.what_to_use(kind, reason));
                sentences
            }
        }
    }

    pub(super) fn best(&self) -> Option<&'a CandidateResult> {
        self.run.candidate(self.ranking.best.as_deref()?)
    }

    /// A number of the summary with the digits that its interval supports.
    pub(super) fn rounded(&mut self, at: &str, value: f64, ends: Option<(f64, f64)>, shown: Shown) -> String {
        let text = words::rounded(value, ends, shown);
        self.numbers.push(Number { at: at.to_owned(), value, shown: text.clone() });
        text
    }

    /// ` (740 to 759)`.
    pub(super) fn interval(&mut self, at: &str, (low, high): (f64, f64), (factor, places, _): Shown) -> String {
        let [low, high] = [("low", low), ("high", high)]
            .map(|(end, value)| self.rounded(&format!("{at}/{end}"), value, Some((low, high)), (factor, places, "")));
        format!(" ({})", words::between(&low, &high))
    }

    /// The interval of an event.
    fn ends_of_event(&self, field: &str) -> Option<(f64, f64)> {
        let interval = self.run.events.as_ref()?.intervals.iter().find(|interval| interval.name == field)?;
        Some((interval.low, interval.high))
    }

    /// Crush, its time and the rebound; where the impact speed is in doubt, what they are if it is right.
    fn crushed(&mut self, is_speed_in_doubt: bool) -> String {
        let Some(events) = &self.run.events else { return String::new() };
        let noun = self.run.test.noun();
        let Some((crush_m, time_s)) = events.dynamic_crush_m.zip(events.time_of_dynamic_crush_s) else {
            return NO_MOTION.to_owned();
        };
        let ends = self.ends_of_event("dynamic_crush_m");
        let crush = self.rounded("/events/dynamic_crush_m", crush_m, ends, CRUSH.shown());
        let time = self.number("/events/time_of_dynamic_crush_s", time_s, in_ms(time_s));
        let rebound = match (events.coefficient_of_restitution, events.rebound_velocity_m_per_s) {
            (Some(e), Some(velocity_m_per_s)) if e > 0.0 => {
                let km_per_h = KM_PER_H_PER_M_PER_S * velocity_m_per_s.abs();
                let shown = words::quantity(km_per_h, usize::from(km_per_h < 3.0), "km/h");
                let at = "/events/rebound_velocity_m_per_s".to_owned();
                self.numbers.push(Number { at, value: velocity_m_per_s, shown: shown.clone() });
                let or_more = if self.run.is_rebound_cut() { " or more" } else { "" };
                format!("; the {noun} rebounded at {shown}{or_more}")
            }
            (Some(e), _) if e <= 0.0 => format!("; the {noun} did not rebound"),
            _ => String::new(),
        };
        let stated = self.run.test.impact_speed_m_per_s.filter(|_| is_speed_in_doubt);
        let condition =
            stated.map(|speed| format!("If {} is right, the", self.speed("/test/impact_speed_m_per_s", speed)));
        format!("{} dynamic crush was {crush} at {time}{rebound}.", condition.as_deref().unwrap_or("The"))
    }

    /// The change of velocity and its time.
    fn change_of_velocity(&mut self) -> Option<(String, Option<String>)> {
        let events = self.run.events.as_ref()?;
        let ends = self.ends_of_event("delta_v_m_per_s");
        let change = self.rounded("/events/delta_v_m_per_s", events.delta_v_m_per_s?, ends, DELTA_V.shown());
        let times = [
            ("/events/time_of_delta_v_s", events.time_of_delta_v_s),
            ("/events/time_of_rebound_s", events.time_of_rebound_s),
        ];
        let time = times.into_iter().find_map(|(at, time)| Some((at, time?)));
        Some((change, time.map(|(at, time_s)| self.number(at, time_s, (MILLI, 1, "ms")))))
    }

    fn no_stop(&mut self) -> String {
        let noun = self.run.test.noun();
        let Some((change, Some(time))) = self.change_of_velocity() else {
            return format!("The {noun} did not stop within the record.");
        };
        let end_s = self.run.events.as_ref().and_then(|events| events.end_of_event_s);
        let another = end_s.is_some_and(|end_s| self.run.impacts.iter().any(|i| i.start_s >= end_s));
        if another {
            return format!(
                "The {noun} did not stop in this impact: it lost {change} in {time}, and another impact followed."
            );
        }
        let bound = bound_of_change(self.run);
        format!("The {noun} did not stop within the record: it lost {bound}{change} in {time}.")
    }

    fn two_vehicles(&mut self) -> String {
        match self.change_of_velocity() {
            Some((change, time)) => {
                let time = time.map_or_else(String::new, |time| format!(" within {time}"));
                format!("Two vehicles collided: this one lost {change}{time}.")
            }
            None => self.changed().unwrap_or_else(|| NO_MOTION.to_owned()),
        }
    }

    /// The change of velocity, the peak, the OLC and the stroke of a pulse without a crush; `None` without a change.
    fn changed(&mut self) -> Option<String> {
        let metric = |name: &str| self.run.metric(name).and_then(|metric: &MetricV1| Some((metric, metric.value?)));
        let delta_v = metric(DELTA_V.key)?;
        let ends = delta_v.0.low.zip(delta_v.0.high);
        let change = self.rounded("/metrics/delta_v/value", delta_v.1, ends, DELTA_V.shown());
        let time = delta_v.0.to_s.map_or_else(String::new, |time_s| {
            let time = self.number("/metrics/delta_v/to_s", time_s, in_ms(time_s));
            format!(" within {time}")
        });
        let [peak, olc, stroke] = [(PEAK, "a peak"), (OLC, "an OLC"), (STROKE, "a stroke")].map(|(quantity, words)| {
            let Some((metric, value)) = metric(quantity.key) else { return String::new() };
            let (at, ends) = (format!("/metrics/{}/value", quantity.key), metric.low.zip(metric.high));
            format!(", {words} of {}", self.rounded(&at, value, ends, quantity.shown()))
        });
        let bound = bound_of_change(self.run);
        Some(format!("The record gives a delta-v of {bound}{change}{time}{peak}{olc}{stroke}."))
    }

    /// Which model to use, what it gives and what it does not; that none is recommended, and why.
    fn what_to_use(&mut self, kind: Kind, reason: &StatusReason) -> Vec<String> {
        use StatusReason::{Beyond, DecisiveWarning, GoodTo};
        let is_of_the_answer = matches!(reason, DecisiveWarning { .. } | GoodTo { .. } | Beyond { .. });
        if is_of_the_answer && reason.status() == Status::DoNotUse {
            return self.asked_for().into_iter().collect();
        }
        let is_lacking = kind == Kind::LinearModel || lacks_mass_or_speed(self.run);
        let mut sentences = Vec::new();
        if let Some(best) = self.best() {
            sentences.extend(self.one_spring(best));
            sentences.push(self.use_model(best));
            sentences.extend(self.caution(best, reason));
        } else if !self.run.candidates.is_empty() {
            sentences.push(none_recommended(&self.why_none(kind)));
            sentences.extend(self.closest());
        } else if is_lacking && !self.run.models.is_empty() {
            sentences.push(self.identified());
        } else if !self.run.test.has_structure() {
            sentences
                .push("A sled is driven by its pulse: there is no crush, and no model for other speeds.".to_owned());
        } else if !is_lacking {
            sentences.push("It holds no models: their stages did not run.".to_owned());
        }
        if is_lacking && self.run.candidates.is_empty() {
            sentences.push(not_stated(self.run).to_owned());
        }
        sentences
    }

    /// One stiffness for a curve on one mass: that of the spring with the energy and the crush of the test.
    fn one_spring(&mut self, best: &CandidateResult) -> Option<String> {
        let is_curve = best.record.parameters.keys().any(|name| name.starts_with("knot"));
        let is_of_one_mass = best.record.parameters.contains_key("mass_kg");
        let spring = self.run.one_spring().filter(|_| is_curve && is_of_one_mass)?;
        let at = format!("/metrics/{}", OneSpring::METRIC);
        let mut stiffness = self.rounded(&format!("{at}/value"), spring.n_per_m, spring.ends, STIFFNESS.shown());
        stiffness.extend(spring.ends.map(|ends| self.interval(&at, ends, STIFFNESS.shown())));
        Some(format!("One spring of {stiffness} has the same energy and crush."))
    }

    /// The recommended model and what it gives for the impact that was asked for.
    fn use_model(&mut self, best: &CandidateResult) -> String {
        let predicts = self.given(best).map(|(prediction, [scenario, crush, interval])| {
            let beyond = if prediction.extrapolates { ", beyond the test," } else { "" };
            format!(": {scenario}{beyond} it gives {crush}{interval}")
        });
        format!("For other speeds use {}{}.", best.in_a_sentence(), predicts.unwrap_or_default())
    }

    /// What the recommended model gives for an impact that a person asked for, whatever speaks against its use.
    fn asked_for(&mut self) -> Option<String> {
        let best = self.best()?;
        answer(self.run, best).filter(|(_, prediction)| prediction.asked)?;
        let (_, [scenario, crush, interval]) = self.given(best)?;
        Some(format!("Asked for: {scenario} {} gives {crush}{interval}.", best.in_a_sentence()))
    }

    /// The prediction that answers, and its impact, crush and interval in words.
    fn given(&mut self, best: &CandidateResult) -> Option<(&'a PredictionV1, [String; 3])> {
        let (place, prediction) = answer(self.run, best)?;
        let crush_m = prediction.dynamic_crush_m?;
        let (at, scenario) = (format!("/predictions/{place}"), self.scenario(place));
        let known = interval_of_crush(prediction).map(|(j, interval)| (j, (interval.low, interval.high)));
        let ends = known.map(|(_, ends)| ends);
        let crush = self.rounded(&format!("{at}/dynamic_crush_m"), crush_m, ends, CRUSH.shown());
        let interval = known.map(|(j, ends)| self.interval(&format!("{at}/intervals/{j}"), ends, CRUSH.shown()));
        Some((prediction, [scenario, crush, interval.unwrap_or_default()]))
    }

    /// How closely a candidate follows the displacement.
    fn follows(&mut self, candidate: &CandidateResult) -> Option<String> {
        let place = self.run.candidates.iter().position(|other| other.id == candidate.id)?;
        let simulation = candidate.simulation.as_ref()?;
        let key = if simulation.fit_as_measured_percent.is_some() { "fit_as_measured_percent" } else { "fit_percent" };
        let at = format!("/candidates/{place}/simulation/{key}");
        Some(self.number(&at, candidate.fit_percent()?, FIT))
    }

    /// The one thing that the model does not give, before all others; what the status says is not said again.
    fn caution(&mut self, best: &CandidateResult, reason: &StatusReason) -> Option<String> {
        if let Some(tests) = self.run.joint.as_ref().and_then(missed) {
            return Some(format!(
                "Predicted from the others, the crush of {tests} is off: quote predictions with that error."
            ));
        }
        if let Some(open) = self.open_parameters(best) {
            return Some(open);
        }
        if best.record.equivalent_to.is_some() && *reason != StatusReason::Dual {
            let dual =
                "The mass split cannot be identified from one sensor: a mirrored (dual) model fits equally well.";
            return Some(dual.to_owned());
        }
        let is_said = matches!(reason, StatusReason::FewDetermined { .. });
        let known = best.certainties();
        let few = (!is_said && known.determined < known.parameters).then(|| {
            let counts = [known.determined, known.parameters];
            as_sentence(&self.few_determined("/verdict", counts, has_only_forces(best)))
        });
        let other = beside(self.run).filter(|other| other != reason);
        let other = other.map(|other| as_sentence(&self.because(&other)));
        few.or(other).or_else(|| {
            let tested_m = self.run.exceeded_tested_crush_m(|p| p.candidate == best.id)?;
            let shown = (MILLI, 0, "mm");
            let crush = match self.run.joint {
                None => self.number("/events/dynamic_crush_m", tested_m, shown),
                Some(_) => words::quantity(MILLI * tested_m, shown.1, shown.2),
            };
            Some(format!("Beyond {crush}, the crush of the test, it extrapolates."))
        })
    }

    /// The parameters that the record does not determine, with the numbers in their names; nothing without any.
    fn open_parameters(&mut self, candidate: &CandidateResult) -> Option<String> {
        let names = candidate.record.undetermined();
        let place = self.run.candidates.iter().position(|other| other.id == candidate.id)?;
        for (name, deflection_m) in names.iter().filter_map(|name| deflection_of_knot(&candidate.record, name)) {
            self.number(&format!("/candidates/{place}/parameters/{name}"), deflection_m, DEFLECTION);
        }
        (!names.is_empty())
            .then(|| format!("Not identifiable from this record: {}.", symbols(&candidate.record, &names)))
    }

    /// Why no model is recommended.
    fn why_none(&self, kind: Kind) -> String {
        let has_no_crush = |events: &EventsV1| events.dynamic_crush_m.is_none_or(|crush| crush <= 0.0);
        match self.run.other_axis() {
            Some(axis) => format!("the pulse is along {axis}, and the models are of a crush along x"),
            None if kind == Kind::TwoVehicles => "its motion over ground is not its crush".to_owned(),
            None if self.run.events.as_ref().is_some_and(has_no_crush) => {
                format!("the {} was not seen to stop", self.run.test.noun())
            }
            None => self.ranking.because.clone(),
        }
    }

    /// The model closest to the record, and how close up to when.
    fn closest(&mut self) -> Option<String> {
        let run = self.run;
        let id = run.recommendation.as_ref().and_then(|choice| choice.closest.as_deref())?;
        let place = run.candidates.iter().position(|other| other.id == id)?;
        let to_s = run.candidates[place].simulation.as_ref()?.to_s;
        let fit = self.follows(&run.candidates[place])?;
        let time = self.number(&format!("/candidates/{place}/simulation/to_s"), to_s, in_ms(to_s));
        Some(format!("The closest, {}, has a displacement fit of {fit} up to {time}.", run.name_of(id)))
    }
}

/// Whether what follows from the impact speed is in doubt with it.
fn is_speed_in_doubt(reason: &StatusReason) -> bool {
    let StatusReason::DecisiveWarning { about, .. } = reason else { return false };
    about.parse() == Ok(About::ImpactSpeed)
}

/// ` with 2000 kg against mpdb`: what of an impact is not as in the test.
pub(crate) fn with_mass_against(mass: Option<String>, partner: Option<&str>) -> String {
    let mass = mass.map(|mass| format!(" with {mass}"));
    let partner = partner.map(|partner| format!(" against {partner}"));
    mass.into_iter().chain(partner).collect()
}

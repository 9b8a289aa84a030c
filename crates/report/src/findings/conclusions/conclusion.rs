//! The result of a run in a word and a few sentences, made by rules from its records.

use crate::drawing::numbers::{KM_PER_H_PER_M_PER_S, MILLI};
use crate::phrases::PHRASES;
use crate::phrases::words::{self, fill};
use crumple_artifact::records::{MetricV1, ModeV1, PredictedIntervalV1, PredictionV1, StabilizationV1};
use crumple_signal::key_quantities::{CRUSH, DELTA_V, KeyQuantity, OLC, PEAK, STIFFNESS, STROKE};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};
use std::borrow::Cow;

use crate::findings::conclusions::concerns::{Concern, concerns};
use crate::findings::conclusions::key_numbers::{bound_of_change, in_ms};
use crate::findings::conclusions::kind::{Kind, ResultStatus, kind_of, lacks_mass_or_speed, not_stated, subject_of};
use crate::findings::conclusions::several_tests::{missed, several_tests};
use crate::findings::conclusions::status::{
    Status, StatusReason, answer, beside, closest_identified, has_only_forces, interval_of_crush, status_reason,
};
use crate::findings::conclusions::uses::{Soundness, Use, good_for, soundness};
use crate::findings::text::{DEFLECTION, deflection_of_knot, listed, symbols};
use crate::findings::text::{as_sentence, candidate_name, model_name};
use crate::findings::{CandidateResult, Ranking, Run};

/// A number of the sentences and where `summary.json` has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
#[schemars(!default)]
pub struct Conclusion {
    /// What kind of record it is about.
    #[serde(deserialize_with = "known")]
    pub kind: Kind,
    /// Whether there is what was asked for.
    #[serde(deserialize_with = "known")]
    pub standing: ResultStatus,
    /// ISO 639-1 code of the language of the sentences: `en`.
    pub language: Cow<'static, str>,
    /// Whether the results may be used; `None`: an early version did not say it.
    #[schemars(with = "Status")]
    pub status: Option<Status>,
    /// Whether the record is sound; `None`: an earlier version did not say it.
    #[schemars(with = "Soundness")]
    pub record: Option<Soundness>,
    /// What the answers are good for.
    pub good_for: Vec<Use>,
    /// Its one reason, typed.
    #[serde(deserialize_with = "known")]
    #[schemars(with = "StatusReason")]
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
    /// How many numbers of the recommended model are determined, rough, open: `3 of 5 determined, 2 open`.
    pub(crate) fn certainty(&self) -> Option<String> {
        let texts = &PHRASES.runs;
        let counts = [("determined", self.determined?.to_string()), ("parameters", self.parameters?.to_string())];
        let mut words = fill(texts.determined, &counts);
        let others = [(self.order_of_magnitude, texts.order_of_magnitude), (self.open, texts.open)];
        for (count, text) in others.into_iter().filter_map(|(count, text)| Some((count.filter(|n| *n > 0)?, text))) {
            words.push_str(&fill(text, &[("count", count.to_string())]));
        }
        Some(words)
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
    let verdict = Conclusion {
        kind,
        standing,
        language: "en".into(),
        status: Some(reason.status()),
        record: Some(soundness(run, kind, &concerns)),
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
    pub(super) fn number(&mut self, at: &str, value: f64, (factor, places, unit): (f64, usize, &str)) -> String {
        let shown = words::quantity(factor * value, places, unit);
        self.numbers.push(Number { at: at.to_owned(), value, shown: shown.clone() });
        shown
    }

    /// `the crush at 40 km/h is predicted to ±16 %`.
    fn because(&mut self, reason: &StatusReason) -> String {
        use StatusReason as Reason;
        let phrases = &PHRASES.conclusion;
        let (percent, mm) = ((1.0, 0, "%"), CRUSH.shown());
        let at = |name: &str| format!("/verdict/status_reason/{name}");
        match reason {
            Reason::GoodTo { good_to_percent, prediction, .. } | Reason::Beyond { good_to_percent, prediction, .. } => {
                let good_to = self.number(&at("good_to_percent"), *good_to_percent, percent);
                let scenario = self.scenario(*prediction);
                let is_beyond = matches!(reason, Reason::Beyond { .. });
                let template = if is_beyond { phrases.because_beyond } else { phrases.because_good_to };
                fill(template, &[("good_to", &good_to), ("scenario", &scenario)])
            }
            Reason::SensorsDiffer { sensors, low_m, high_m, half_width_m, .. } => {
                let (factor, places, _) = mm;
                let texts = [
                    ("low", self.number(&at("low_m"), *low_m, (factor, places, ""))),
                    ("high", self.number(&at("high_m"), *high_m, mm)),
                    ("half_width", self.number(&at("half_width_m"), *half_width_m, mm)),
                    ("count", self.number(&at("sensors"), *sensors as f64, (1.0, 0, ""))),
                ];
                fill(phrases.because_sensors, &texts)
            }
            Reason::FewDetermined { determined, parameters, are_forces } => {
                let template = if *are_forces { phrases.because_few_forces } else { phrases.because_few_parameters };
                let texts = [
                    ("determined", self.number(&at("determined"), *determined as f64, (1.0, 0, ""))),
                    ("parameters", self.number(&at("parameters"), *parameters as f64, (1.0, 0, ""))),
                    ("are", words::verb(*determined).to_owned()),
                ];
                fill(template, &texts)
            }
            Reason::DecisiveWarning { number, about } => {
                let number = self.number(&at("number"), *number as f64, (1.0, 0, ""));
                fill(phrases.because_decisive, &[("subject", subject_of(about)), ("number", &number)])
            }
            Reason::Check { number, about } => {
                let number = self.number(&at("number"), *number as f64, (1.0, 0, ""));
                fill(phrases.because_check, &[("subject", subject_of(about)), ("number", &number)])
            }
            Reason::PoorFit { fit_percent, limit_percent } => {
                let texts = [
                    ("fit", self.number(&at("fit_percent"), *fit_percent, (1.0, 1, "%"))),
                    ("limit", self.number(&at("limit_percent"), *limit_percent, percent)),
                ];
                fill(phrases.because_poor_fit, &texts)
            }
            Reason::MissesItsTest { events } => {
                let names: Vec<String> = events.iter().map(|name| words::metric(name)).collect();
                fill(phrases.because_misses_its_test, &[("events", listed(&names, phrases.and))])
            }
            Reason::Weak { candidate } => fill(phrases.because_weak, &[("model", candidate_name(candidate))]),
            Reason::Contrary { candidate } => fill(phrases.because_contrary, &[("model", candidate_name(candidate))]),
            Reason::OtherAxis { axis } => fill(phrases.because_other_axis, &[("axis", axis)]),
            Reason::Unassessed => phrases.because_unassessed.to_owned(),
            Reason::Dual => phrases.because_dual.to_owned(),
            Reason::NoInterval => phrases.because_no_interval.to_owned(),
            Reason::TestsDisagree => phrases.because_tests_disagree.to_owned(),
            Reason::NoStop => phrases.because_no_stop.to_owned(),
            Reason::TwoVehicles => phrases.because_two_vehicles.to_owned(),
            Reason::Occupant => phrases.because_occupant.to_owned(),
            Reason::Recorder => phrases.because_recorder.to_owned(),
            Reason::Identified => phrases.because_identified.to_owned(),
            Reason::NoMass => phrases.because_no_mass.to_owned(),
            Reason::NoSpeed => phrases.because_no_speed.to_owned(),
            Reason::NoMassNorSpeed => phrases.because_no_mass_nor_speed.to_owned(),
            Reason::MeasuredOnly => phrases.because_measured_only.to_owned(),
            Reason::NoneRecommended => phrases.because_none_recommended.to_owned(),
            Reason::NoResult => phrases.because_no_result.to_owned(),
            Reason::NotAdequate => phrases.because_not_adequate.to_owned(),
            Reason::NoneAdequate => phrases.because_none_adequate.to_owned(),
        }
    }

    /// `at 40 km/h with 2000 kg against mpdb`: the mass where it is not that of the test.
    fn scenario(&mut self, place: usize) -> String {
        let phrases = &PHRASES.conclusion;
        let Some(prediction) = self.run.predictions.get(place) else { return String::new() };
        let PredictionV1 { impact_speed_m_per_s, mass_kg, partner, .. } = prediction;
        let speed = self.speed(&format!("/predictions/{place}/impact_speed_m_per_s"), *impact_speed_m_per_s);
        let mass = (!self.run.is_of_own_mass(prediction)).then(|| {
            let mass = self.number(&format!("/predictions/{place}/mass_kg"), *mass_kg, (1.0, 0, "kg"));
            fill(phrases.with_mass, &[("mass", mass)])
        });
        let partner = partner.as_ref().map(|partner| fill(phrases.against_partner, &[("partner", partner)]));
        let texts = [("speed", speed), ("mass", mass.unwrap_or_default()), ("partner", partner.unwrap_or_default())];
        fill(phrases.scenario, &texts)
    }

    /// A speed in km/h, with a decimal where it has one.
    fn speed(&mut self, at: &str, speed_m_per_s: f64) -> String {
        let km_per_h = KM_PER_H_PER_M_PER_S * speed_m_per_s;
        let places = usize::from((km_per_h - km_per_h.round()).abs() >= 0.05);
        self.number(at, speed_m_per_s, (KM_PER_H_PER_M_PER_S, places, "km/h"))
    }

    fn sentences(&mut self, kind: Kind, reason: &StatusReason, concerns: &[Concern]) -> Vec<String> {
        let phrases = &PHRASES.conclusion;
        match kind {
            Kind::NoModel => {
                let diagnosis = concerns.iter().find(|concern| concern.is_no_result());
                let reason = diagnosis.map_or("", |concern| concern.text.as_str());
                let remedy = diagnosis.and_then(|concern| concern.remedy.as_deref()).unwrap_or(phrases.read_the_notes);
                vec![fill(phrases.no_model, &[("reason", reason)]), fill(phrases.what_to_do, &[("remedy", remedy)])]
            }
            Kind::InputOutput => {
                let is_bad = reason.status() == Status::DoNotUse && closest_identified(self.run).is_some();
                let no_use = is_bad.then(|| phrases.identified_no_use.to_owned());
                std::iter::once(self.identified()).chain(no_use).collect()
            }
            Kind::Occupant => vec![self.occupant(), self.occupant_use(concerns)],
            Kind::Recorder => {
                let energy = self.recorder_energy();
                [Some(self.recorded()), energy, Some(self.recorder_use())].into_iter().flatten().collect()
            }
            _ => {
                let happened = match kind {
                    // The way of a pulse along another axis is no crush.
                    Kind::Barrier if self.run.other_axis().is_none() => self.crushed(),
                    Kind::NoStop => self.no_stop(),
                    Kind::TwoVehicles => self.two_vehicles(),
                    Kind::SeveralTests => self.run.joint.as_ref().map_or_else(String::new, several_tests),
                    _ => self.changed().unwrap_or_else(|| phrases.measured_only.to_owned()),
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

    /// ` (739.8 to 759.1)`.
    pub(super) fn interval(
        &mut self,
        at: &str,
        low: f64,
        high: f64,
        (factor, places, _): (f64, usize, &str),
    ) -> String {
        let low = self.number(&format!("{at}/low"), low, (factor, places, ""));
        let high = self.number(&format!("{at}/high"), high, (factor, places, ""));
        fill(PHRASES.conclusion.interval, &[("low", low), ("high", high)])
    }

    fn crushed(&mut self) -> String {
        let phrases = &PHRASES.conclusion;
        let Some(events) = &self.run.events else { return String::new() };
        let Some((crush_m, time_s)) = events.dynamic_crush_m.zip(events.time_of_dynamic_crush_s) else {
            return phrases.measured_only.to_owned();
        };
        let crush = self.number("/events/dynamic_crush_m", crush_m, CRUSH.shown());
        let time = self.number("/events/time_of_dynamic_crush_s", time_s, in_ms(time_s));
        let rebound = match (events.coefficient_of_restitution, events.rebound_velocity_m_per_s) {
            (Some(e), Some(velocity_m_per_s)) if e > 0.0 => {
                let km_per_h = KM_PER_H_PER_M_PER_S * velocity_m_per_s.abs();
                let shown = words::quantity(km_per_h, usize::from(km_per_h < 3.0), "km/h");
                let at = "/events/rebound_velocity_m_per_s".to_owned();
                self.numbers.push(Number { at, value: velocity_m_per_s, shown: shown.clone() });
                let is_cut = self.run.is_rebound_cut();
                fill(if is_cut { phrases.rebounded_at_least } else { phrases.rebounded }, &[("speed", shown)])
            }
            (Some(e), _) if e <= 0.0 => phrases.no_rebound.to_owned(),
            _ => String::new(),
        };
        fill(phrases.crushed, &[("crush", crush), ("time", time), ("rebound", rebound)])
    }

    /// The change of velocity and its time.
    fn change_of_velocity(&mut self) -> Option<(String, Option<String>)> {
        let events = self.run.events.as_ref()?;
        let change = self.number("/events/delta_v_m_per_s", events.delta_v_m_per_s?, DELTA_V.shown());
        let times = [
            ("/events/time_of_delta_v_s", events.time_of_delta_v_s),
            ("/events/time_of_rebound_s", events.time_of_rebound_s),
        ];
        let time = times.into_iter().find_map(|(at, time)| Some((at, time?)));
        Some((change, time.map(|(at, time_s)| self.number(at, time_s, (MILLI, 1, "ms")))))
    }

    fn no_stop(&mut self) -> String {
        let phrases = &PHRASES.conclusion;
        match self.change_of_velocity() {
            Some((change, Some(time))) => {
                let end_s = self.run.events.as_ref().and_then(|events| events.end_of_event_s);
                let another = end_s.is_some_and(|end_s| self.run.impacts.iter().any(|i| i.start_s >= end_s));
                let phrase = if another { phrases.no_stop_in_impact } else { phrases.no_stop };
                fill(phrase, &[("bound", bound_of_change(self.run)), ("change", &change), ("time", &time)])
            }
            _ => phrases.no_stop_no_end.to_owned(),
        }
    }

    fn two_vehicles(&mut self) -> String {
        let phrases = &PHRASES.conclusion;
        match self.change_of_velocity() {
            Some((change, time)) => {
                let time = time.map_or_else(String::new, |time| fill(phrases.within, &[("time", time)]));
                fill(phrases.two_vehicles, &[("change", &change), ("time", &time)])
            }
            None => self.changed().unwrap_or_else(|| phrases.no_stop_no_end.to_owned()),
        }
    }

    /// The change of velocity, the peak, the OLC and the stroke of a pulse without a crush; `None` without a change.
    fn changed(&mut self) -> Option<String> {
        let phrases = &PHRASES.conclusion;
        let metric = |name: &str| self.run.metric(name).and_then(|metric: &MetricV1| Some((metric, metric.value?)));
        let delta_v = metric(DELTA_V.key)?;
        let change = self.number("/metrics/delta_v/value", delta_v.1, DELTA_V.shown());
        let time = delta_v.0.to_s.map_or_else(String::new, |time_s| {
            let time = self.number("/metrics/delta_v/to_s", time_s, in_ms(time_s));
            fill(phrases.within, &[("time", time)])
        });
        let [peak, olc, stroke] =
            [(PEAK, phrases.and_peak, "peak"), (OLC, phrases.and_olc, "olc"), (STROKE, phrases.and_stroke, "stroke")]
                .map(|(KeyQuantity { key, factor, decimals, unit, .. }, phrase, name)| {
                    let Some((_, value)) = metric(key) else { return (name, String::new()) };
                    let at = format!("/metrics/{key}/value");
                    (name, fill(phrase, &[(name, self.number(&at, value, (factor, decimals, unit)))]))
                });
        let bound = ("bound", bound_of_change(self.run).to_owned());
        Some(fill(phrases.changed, &[bound, ("change", change), ("time", time), peak, olc, stroke]))
    }

    /// The recommended identified model, else the one that follows the record closest.
    fn identified(&mut self) -> String {
        let phrases = &PHRASES.conclusion;
        if let Some(ambient) = self.run.ambient() {
            return self.ambient(ambient);
        }
        let Some((k, model, fit)) = closest_identified(self.run) else { return phrases.identified_none.to_owned() };
        let fit = self.number(&format!("/models/{k}/fit_percent"), fit, (1.0, 1, "%"));
        let unseen = model.unseen_fit_percent().map_or_else(String::new, |unseen| {
            let unseen = self.number(&format!("/models/{k}/unseen_fit_percent"), unseen, (1.0, 1, "%"));
            fill(phrases.unseen, &[("fit", &unseen)])
        });
        if !model.holds() {
            return fill(phrases.identified_fails, &[("model", &model.id), ("fit", &fit), ("unseen", &unseen)]);
        }
        // What grows is unstable, and no mode of what was measured.
        let decays = |mode: &ModeV1| mode.im_rad_per_s > 0.0 && mode.re_per_s < 0.0;
        let modes = model.modes.iter().enumerate().filter(|(_, mode)| decays(mode));
        let slowest =
            modes.min_by(|(_, a), (_, b)| a.natural_frequency_rad_per_s.total_cmp(&b.natural_frequency_rad_per_s));
        let mode = slowest.map_or_else(String::new, |(j, mode)| {
            let at = format!("/models/{k}/modes/{j}");
            let hz = (1.0 / std::f64::consts::TAU, 2, "Hz");
            let w = self.number(&format!("{at}/natural_frequency_rad_per_s"), mode.natural_frequency_rad_per_s, hz);
            let damping = mode.damping_ratio.map_or_else(String::new, |ratio| {
                let ratio = self.number(&format!("{at}/damping_ratio"), ratio, (1.0, 3, ""));
                fill(phrases.damping, &[("ratio", &ratio)])
            });
            fill(phrases.mode, &[("frequency", &w), ("damping", &damping)])
        });
        let text = if self.run.is_recommended(&model.id) { phrases.identified_chosen } else { phrases.identified };
        fill(text, &[("model", &model.id), ("fit", &fit), ("unseen", &unseen), ("mode", &mode)])
    }

    /// The modes of an ambient record, the slowest first.
    fn ambient(&mut self, diagram: &StabilizationV1) -> String {
        let phrases = &PHRASES.conclusion;
        let mut all: Vec<f64> = diagram.clusters.iter().map(|c| c.natural_frequency_rad_per_s).collect();
        all.sort_by(f64::total_cmp);
        let shown: Vec<String> = all.iter().map(|w| words::quantity(w / std::f64::consts::TAU, 2, "Hz")).collect();
        let modes = if shown.is_empty() { phrases.no_mode.to_owned() } else { shown.join(", ") };
        fill(phrases.ambient, &[("modes", modes)])
    }

    /// Which model to use, what it gives and what it does not; that none is recommended, and why.
    fn what_to_use(&mut self, kind: Kind, reason: &StatusReason) -> Vec<String> {
        let phrases = &PHRASES.conclusion;
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
            sentences.push(self.none_recommended());
            sentences.extend(self.closest());
        } else if is_lacking && !self.run.models.is_empty() {
            sentences.push(self.identified());
        } else if !self.run.test.has_structure() {
            sentences.push(phrases.no_structure.to_owned());
        } else if !is_lacking {
            sentences.push(phrases.no_models_here.to_owned());
        }
        if is_lacking && self.run.candidates.is_empty() {
            sentences.push(not_stated(self.run).to_owned());
        }
        sentences
    }

    /// One stiffness for a curve on one mass: that of the spring with the energy and the crush of the test.
    fn one_spring(&mut self, best: &CandidateResult) -> Option<String> {
        let is_curve = best.record.parameters.keys().any(|name| name.starts_with("knot"));
        let metric = self.run.metric("average_stiffness")?;
        let value = metric.value.filter(|_| is_curve && best.record.parameters.contains_key("mass_kg"))?;
        let at = "/metrics/average_stiffness";
        let mut stiffness = self.number(&format!("{at}/value"), value, STIFFNESS.shown());
        if let Some((low, high)) = metric.low.zip(metric.high) {
            stiffness.push_str(&self.interval(at, low, high, STIFFNESS.shown()));
        }
        Some(fill(PHRASES.conclusion.one_spring, &[("stiffness", stiffness)]))
    }

    /// The recommended model and what it gives for the impact that was asked for.
    fn use_model(&mut self, best: &CandidateResult) -> String {
        let phrases = &PHRASES.conclusion;
        let predicts = self.given(best).map(|(prediction, texts)| {
            fill(if prediction.extrapolates { phrases.predicts_beyond } else { phrases.predicts }, &texts)
        });
        let texts = [("model", self.named(best)), ("predicts", predicts.unwrap_or_default())];
        fill(phrases.use_model, &texts)
    }

    /// What the recommended model gives for an impact that a person asked for, whatever speaks against its use.
    fn asked_for(&mut self) -> Option<String> {
        let best = self.best()?;
        answer(self.run, best).filter(|(_, prediction)| prediction.asked)?;
        let (_, [scenario, crush, interval]) = self.given(best)?;
        let texts = [scenario, ("model", self.named(best)), crush, interval];
        Some(fill(PHRASES.conclusion.asked_for, &texts))
    }

    fn named(&self, candidate: &CandidateResult) -> String {
        let phrases = &PHRASES.conclusion;
        match candidate.record.model.as_str() {
            "force-deflection" => phrases.force_deflection_curve.to_owned(),
            other => fill(phrases.named_model, &[("model", model_name(other))]),
        }
    }

    /// The prediction that answers, and its impact, crush and interval in words.
    fn given(&mut self, best: &CandidateResult) -> Option<(&'a PredictionV1, [(&'static str, String); 3])> {
        let (place, prediction) = answer(self.run, best)?;
        let crush_m = prediction.dynamic_crush_m?;
        let (at, scenario) = (format!("/predictions/{place}"), self.scenario(place));
        let crush = self.number(&format!("{at}/dynamic_crush_m"), crush_m, CRUSH.shown());
        let interval = interval_of_crush(prediction).map(|(j, &PredictedIntervalV1 { low, high, .. })| {
            self.interval(&format!("{at}/intervals/{j}"), low, high, CRUSH.shown())
        });
        let texts = [("scenario", scenario), ("crush", crush), ("interval", interval.unwrap_or_default())];
        Some((prediction, texts))
    }

    /// How closely a candidate follows the displacement.
    fn follows(&mut self, candidate: &CandidateResult) -> Option<String> {
        let place = self.run.candidates.iter().position(|other| other.id == candidate.id)?;
        let simulation = candidate.simulation.as_ref()?;
        let key = if simulation.fit_as_measured_percent.is_some() { "fit_as_measured_percent" } else { "fit_percent" };
        let at = format!("/candidates/{place}/simulation/{key}");
        Some(self.number(&at, candidate.fit_percent()?, (1.0, 1, "%")))
    }

    /// The one thing that the model does not give, before all others; what the status says is not said again.
    fn caution(&mut self, best: &CandidateResult, reason: &StatusReason) -> Option<String> {
        let phrases = &PHRASES.conclusion;
        if let Some(tests) = self.run.joint.as_ref().and_then(missed) {
            return Some(fill(PHRASES.joint.tests_disagree, &[("tests", tests)]));
        }
        if let Some(open) = self.with_names(best, phrases.open_numbers, &best.record.undetermined()) {
            return Some(open);
        }
        if best.record.equivalent_to.is_some() && *reason != StatusReason::Dual {
            return Some(phrases.dual.to_owned());
        }
        let is_said = matches!(reason, StatusReason::FewDetermined { .. });
        let few = if is_said { None } else { self.few_determined(best) };
        let other = beside(self.run).filter(|other| other != reason);
        let other = other.map(|other| as_sentence(&self.because(&other)));
        few.or(other).or_else(|| {
            let tested_m = self.run.exceeded_tested_crush_m(|p| p.candidate == best.id)?;
            let shown = (MILLI, 0, "mm");
            let crush = match self.run.joint {
                None => self.number("/events/dynamic_crush_m", tested_m, shown),
                Some(_) => words::quantity(MILLI * tested_m, shown.1, shown.2),
            };
            Some(fill(phrases.extrapolates, &[("crush", crush)]))
        })
    }

    /// Says how many of the numbers of a model are determined, if not all.
    fn few_determined(&mut self, best: &CandidateResult) -> Option<String> {
        let known = best.certainties();
        let phrases = &PHRASES.conclusion;
        let template = if has_only_forces(best) { phrases.few_forces } else { phrases.few_parameters };
        let mut count = |name: &str, count: usize| {
            (name.to_owned(), self.number(&format!("/verdict/{name}"), count as f64, (1.0, 0, "")))
        };
        (known.determined < known.parameters).then(|| {
            let are = ("are".to_owned(), words::verb(known.determined).to_owned());
            let texts = [count("determined", known.determined), count("parameters", known.parameters), are];
            fill(template, &texts.each_ref().map(|(name, text)| (name.as_str(), text)))
        })
    }

    /// A template with the names of some parameters in it, and the numbers in these names taken; nothing without any.
    fn with_names(&mut self, candidate: &CandidateResult, template: &str, names: &[&str]) -> Option<String> {
        let place = self.run.candidates.iter().position(|other| other.id == candidate.id)?;
        for (name, deflection_m) in names.iter().filter_map(|name| deflection_of_knot(&candidate.record, name)) {
            self.number(&format!("/candidates/{place}/parameters/{name}"), deflection_m, DEFLECTION);
        }
        (!names.is_empty()).then(|| fill(template, &[("names", &symbols(&candidate.record, names))]))
    }

    fn none_recommended(&mut self) -> String {
        let (phrases, run) = (&PHRASES.conclusion, self.run);
        let no_crush =
            run.events.as_ref().is_some_and(|events| events.dynamic_crush_m.is_none_or(|crush| crush <= 0.0));
        let because = match run.other_axis() {
            Some(axis) => fill(phrases.other_axis, &[("axis", &axis.to_string())]),
            None if no_crush => phrases.no_crush.to_owned(),
            None => self.ranking.because.clone(),
        };
        fill(phrases.none_recommended, &[("because", &because)])
    }

    /// The model closest to the record, and how close up to when.
    fn closest(&mut self) -> Option<String> {
        let run = self.run;
        let id = run.recommendation.as_ref().and_then(|choice| choice.closest.as_deref())?;
        let place = run.candidates.iter().position(|other| other.id == id)?;
        let to_s = run.candidates[place].simulation.as_ref()?.to_s;
        let fit = self.follows(&run.candidates[place])?;
        let time = self.number(&format!("/candidates/{place}/simulation/to_s"), to_s, in_ms(to_s));
        let texts = [("model", candidate_name(id)), ("fit", fit), ("time", time)];
        Some(fill(PHRASES.conclusion.closest, &texts))
    }
}

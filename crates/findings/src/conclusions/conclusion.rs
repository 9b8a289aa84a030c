//! The result of a run in two sentences, made by rules from its records.

use crumple_artifact::records::{ConcernV1, EventIntervalV1, PredictedIntervalV1, PredictionV1};
use crumple_drawing::numbers::{G_PER_M_PER_S2, KM_PER_H_PER_M_PER_S, MILLI};
use crumple_phrases::language::{Language, fill};
use crumple_signal::Axis;
use schemars::JsonSchema;
use serde::Serialize;

use crate::conclusions::concerns::{concerns, first_is_decisive};
use crate::conclusions::key_numbers::{KeyNumber, key_numbers, level_percent, sign_of};
use crate::conclusions::kind::{Kind, RECORDED, kind_of, lacks_mass_or_speed, not_stated};
use crate::conclusions::several_tests::{missed, several_tests};
use crate::text::names::candidate_name;
use crate::text::parameters::{DEFLECTION, deflection_of_knot, symbols};
use crate::{CandidateResult, Certainties, Model, Ranking, Run};

/// Whether what was asked for is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Standing {
    /// A model is recommended, or the identified one is the result.
    Model,
    /// There are results, and no model is recommended.
    NoneRecommended,
    /// There is no acceptable result.
    NoResult,
}

/// A number of the sentences and where `summary.json` has it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Number {
    /// JSON pointer into the summary.
    pub at: String,
    /// The value there.
    pub value: f64,
    /// What is shown of it.
    pub shown: String,
}

/// The verdict.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Conclusion {
    /// What kind of record it is about.
    pub kind: Kind,
    /// Whether there is what was asked for.
    pub standing: Standing,
    /// ISO 639-1 code of its language.
    pub language: &'static str,
    /// What happened; which model, how sure, what to distrust.
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

/// The verdict on a run and its concerns.
pub fn conclusion(run: &Run, ranking: &Ranking) -> (Conclusion, Vec<ConcernV1>) {
    let language = run.language;
    let kind = kind_of(run);
    let concerns = concerns(run, ranking, kind);
    let mut text = Text { run, ranking, language, numbers: Vec::new() };
    let sentences = text.sentences(kind, &concerns);
    let diagnosis = concerns.iter().find(|concern| concern.severity == ConcernV1::NO_RESULT);
    let best = text.best();
    let standing = match kind {
        Kind::NoModel => Standing::NoResult,
        _ if best.is_some() || matches!(kind, Kind::InputOutput | Kind::LinearModel) => Standing::Model,
        _ => Standing::NoneRecommended,
    };
    let verdict = Conclusion {
        kind,
        standing,
        language: language.code(),
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
struct Text<'a> {
    run: &'a Run,
    ranking: &'a Ranking,
    language: Language,
    numbers: Vec<Number>,
}

impl<'a> Text<'a> {
    /// A number of the summary, shown by `factor`, so many decimals and the unit.
    fn number(&mut self, at: &str, value: f64, (factor, places, unit): (f64, usize, &str)) -> String {
        let shown = self.language.quantity(factor * value, places, unit);
        self.numbers.push(Number { at: at.to_owned(), value, shown: shown.clone() });
        shown
    }

    fn sentences(&mut self, kind: Kind, concerns: &[ConcernV1]) -> Vec<String> {
        let phrases = &self.language.phrases().conclusion;
        let (first, second) = match kind {
            Kind::Barrier => (self.crushed(), self.use_model(kind, concerns)),
            Kind::NoStop => (self.no_stop(), self.use_model(kind, concerns)),
            Kind::TwoVehicles => (self.two_vehicles(), self.use_model(kind, concerns)),
            Kind::SeveralTests => (
                self.run.joint.as_ref().map_or_else(String::new, |joint| several_tests(joint, self.language)),
                self.use_model(kind, concerns),
            ),
            Kind::Occupant => (self.occupant(), self.occupant_use(concerns)),
            Kind::Recorder => (self.recorded(), self.recorder_use()),
            Kind::InputOutput => (self.identified(phrases.identified), Some(phrases.identified_use.to_owned())),
            Kind::LinearModel => (not_stated(self.run).to_owned(), Some(self.identified(phrases.not_stated_use))),
            Kind::NoModel => {
                let diagnosis = concerns.iter().find(|concern| concern.severity == ConcernV1::NO_RESULT);
                let reason = diagnosis.map_or("", |concern| concern.text.as_str());
                let remedy = diagnosis.and_then(|concern| concern.remedy.as_deref()).unwrap_or(phrases.read_the_notes);
                (fill(phrases.no_model, &[("reason", reason)]), Some(fill(phrases.what_to_do, &[("remedy", remedy)])))
            }
            Kind::MeasuredOnly if lacks_mass_or_speed(self.run) => {
                (not_stated(self.run).to_owned(), self.use_model(kind, concerns))
            }
            Kind::MeasuredOnly => (phrases.measured_only.to_owned(), self.use_model(kind, concerns)),
        };
        std::iter::once(first).chain(second).collect()
    }

    fn best(&self) -> Option<&'a CandidateResult> {
        self.run.candidate(self.ranking.best.as_deref()?)
    }

    /// ` (739.8 to 759.1 mm)` of an event; nothing without an interval.
    fn interval_of_event(&mut self, name: &str, shown: (f64, usize, &str)) -> String {
        let mut intervals = self.run.events.iter().flat_map(|events| events.intervals.iter()).enumerate();
        let Some((index, found)) = intervals.find(|(_, interval)| interval.name == name) else { return String::new() };
        let EventIntervalV1 { low, high, interval_by, .. } = found;
        self.interval(&format!("/events/intervals/{index}"), *low, *high, level_percent(interval_by), shown)
    }

    /// ` (90 %: 739.8 to 759.1 mm)`, without a level where there is none.
    fn interval(&mut self, at: &str, low: f64, high: f64, level: Option<u8>, shown: (f64, usize, &str)) -> String {
        let (factor, places, unit) = shown;
        let low = self.number(&format!("{at}/low"), low, (factor, places, ""));
        let high = self.number(&format!("{at}/high"), high, (factor, places, unit));
        let texts = [("level", self.language.level(level)), ("low", low), ("high", high)];
        fill(self.language.phrases().conclusion.interval, &texts)
    }

    fn crushed(&mut self) -> String {
        let phrases = &self.language.phrases().conclusion;
        let Some(events) = &self.run.events else { return String::new() };
        let mm = (MILLI, 1, "mm");
        let crush = events.dynamic_crush_m.map_or_else(String::new, |c| self.number("/events/dynamic_crush_m", c, mm));
        let interval = self.interval_of_crush(mm);
        let time = events
            .time_of_dynamic_crush_s
            .map_or_else(String::new, |t| self.number("/events/time_of_dynamic_crush_s", t, (MILLI, 1, "ms")));
        let rebound = match events.coefficient_of_restitution {
            Some(e) if e > 0.0 => {
                let e = self.number("/events/coefficient_of_restitution", e, (1.0, 2, ""));
                fill(phrases.rebounded, &[("restitution", &e)])
            }
            Some(_) => phrases.no_rebound.to_owned(),
            None => String::new(),
        };
        let speed = self.impact_speed().map_or_else(String::new, |speed| fill(phrases.at_speed, &[("speed", speed)]));
        let texts = [("crush", crush), ("interval", interval), ("time", time), ("speed", speed), ("rebound", rebound)];
        fill(phrases.crushed, &texts.each_ref().map(|(name, text)| (*name, text.as_str())))
    }

    /// The interval of the crush; where a sensor at the same place lies outside of it, what they all say too.
    fn interval_of_crush(&mut self, shown: (f64, usize, &str)) -> String {
        let numbers = key_numbers(self.run);
        let found = numbers.iter().enumerate().find(|(_, number)| number.name == "dynamic_crush");
        let Some((place, KeyNumber { low: Some(low), high: Some(high), spread: Some(spread), interval_by, .. })) =
            found.filter(|(_, number)| number.interval_misses_a_sensor())
        else {
            return self.interval_of_event("dynamic_crush_m", shown);
        };
        let (at, (factor, places, unit)) = (format!("/key_numbers/{place}"), shown);
        let low = self.number(&format!("{at}/low"), *low, (factor, places, ""));
        let high = self.number(&format!("{at}/high"), *high, (factor, places, unit));
        let lowest = self.number(&format!("{at}/spread/low"), spread.low, (factor, places, ""));
        let highest = self.number(&format!("{at}/spread/high"), spread.high, (factor, places, unit));
        let level = self.language.level(interval_by.as_deref().and_then(level_percent));
        let texts = [("level", level), ("low", low), ("high", high), ("lowest", lowest), ("highest", highest)];
        fill(self.language.phrases().conclusion.interval_and_sensors, &texts)
    }

    fn impact_speed(&mut self) -> Option<String> {
        let speed = self.run.test.impact_speed_m_per_s?;
        Some(self.number("/test/impact_speed_m_per_s", speed, (KM_PER_H_PER_M_PER_S, 1, "km/h")))
    }

    /// The change of velocity and its time.
    fn change_of_velocity(&mut self) -> Option<(String, Option<String>)> {
        let events = self.run.events.as_ref()?;
        let change = self.number("/events/delta_v_m_per_s", events.delta_v_m_per_s?, (KM_PER_H_PER_M_PER_S, 1, "km/h"));
        let times = [
            ("/events/time_of_delta_v_s", events.time_of_delta_v_s),
            ("/events/time_of_rebound_s", events.time_of_rebound_s),
        ];
        let time = times.into_iter().find_map(|(at, time)| Some((at, time?)));
        Some((change, time.map(|(at, time_s)| self.number(at, time_s, (MILLI, 1, "ms")))))
    }

    fn no_stop(&mut self) -> String {
        let phrases = &self.language.phrases().conclusion;
        match self.change_of_velocity() {
            Some((change, Some(time))) => fill(phrases.no_stop, &[("change", &change), ("time", &time)]),
            _ => phrases.no_stop_no_end.to_owned(),
        }
    }

    fn two_vehicles(&mut self) -> String {
        let phrases = &self.language.phrases().conclusion;
        match self.change_of_velocity() {
            Some((change, time)) => {
                let time = time.map_or_else(String::new, |time| fill(phrases.within, &[("time", time)]));
                fill(phrases.two_vehicles, &[("change", &change), ("time", &time)])
            }
            None => phrases.no_stop_no_end.to_owned(),
        }
    }

    fn occupant(&mut self) -> String {
        let mut criteria = Vec::new();
        for (name, label, unit) in [
            ("hic15", "HIC15", (1.0, 0, "")),
            ("hic36", "HIC36", (1.0, 0, "")),
            ("clip_3ms_contiguous", self.language.phrases().numbers.clip_3ms, (G_PER_M_PER_S2, 1, "g")),
        ] {
            // The summary has a name once, as the run finds it.
            let Some((value, metric)) = self.run.metric(name).and_then(|m| m.value.zip(Some(m))) else { continue };
            let number = self.number(&format!("/metrics/{name}/value"), value, unit);
            criteria.push(format!("{label} {}{number}", sign_of(self.run, metric)));
        }
        let criteria = if criteria.is_empty() { String::new() } else { format!(": {}", criteria.join(", ")) };
        let place = self.run.channel().map_or("", |channel| channel.location.as_str());
        fill(self.language.phrases().conclusion.occupant, &[("place", place), ("criteria", &criteria)])
    }

    fn occupant_use(&self, concerns: &[ConcernV1]) -> Option<String> {
        let phrases = &self.language.phrases().conclusion;
        let partial = concerns.iter().any(|concern| concern.about == "occupants" && concern.stage != "report");
        Some(fill(phrases.occupant_use, &[("bounds", if partial { phrases.lower_bounds } else { "" })]))
    }

    fn recorded(&mut self) -> String {
        let recorded = self.run.metric(RECORDED).and_then(|metric| Some((metric.value?, metric.from_s)));
        let Some((value, from_s)) = recorded else { return String::new() };
        let at = format!("/metrics/{RECORDED}");
        let change = self.number(&format!("{at}/value"), value, (KM_PER_H_PER_M_PER_S, 1, "km/h"));
        let time = from_s.map_or_else(String::new, |time_s| {
            let time = self.number(&format!("{at}/from_s"), time_s, (MILLI, 0, "ms"));
            fill(self.language.phrases().conclusion.reached, &[("time", time)])
        });
        fill(self.language.phrases().conclusion.recorded, &[("change", &change), ("time", &time)])
    }

    fn recorder_use(&mut self) -> Option<String> {
        let phrases = &self.language.phrases().conclusion;
        let mm = (MILLI, 0, "mm");
        let crush = self.run.events.as_ref().and_then(|events| events.dynamic_crush_m).map(|crush_m| {
            let crush = self.number("/events/dynamic_crush_m", crush_m, mm);
            let interval = self.interval_of_event("dynamic_crush_m", mm);
            fill(phrases.rough_crush, &[("crush", &crush), ("interval", &interval)])
        });
        let none = if self.best().is_none() { phrases.recorder_without_model } else { "" };
        Some(fill(phrases.recorder_use, &[("crush", crush.as_deref().unwrap_or_default()), ("none", none)]))
    }

    /// The identified model that follows the record closest.
    fn identified(&mut self, template: &str) -> String {
        let (phrases, run) = (&self.language.phrases().conclusion, self.run);
        let fit_of = |model: &Model| model.identification.as_ref().and_then(|i| i.fit_percent);
        let fitted = run.models.iter().enumerate().filter_map(|(k, model)| Some((k, model, fit_of(model)?)));
        let best = fitted.max_by(|(a, _, x), (b, _, y)| x.total_cmp(y).then(b.cmp(a)));
        let Some((k, model, fit)) = best else { return phrases.measured_only.to_owned() };
        let fit = self.number(&format!("/models/{k}/fit_percent"), fit, (1.0, 1, "%"));
        let modes = model.modes.iter().enumerate().filter(|(_, mode)| mode.im_rad_per_s > 0.0);
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
        fill(template, &[("model", &model.id), ("fit", &fit), ("mode", &mode)])
    }

    /// Which model to use, how sure it is and what to distrust; that none is recommended, and why.
    fn use_model(&mut self, kind: Kind, concerns: &[ConcernV1]) -> Option<String> {
        let phrases = &self.language.phrases().conclusion;
        if self.run.candidates.is_empty() {
            return Some(phrases.no_models_here.to_owned());
        }
        let Some(best) = self.best() else { return Some(self.none_recommended()) };
        let certainties = best.certainties();
        let determined = certainties.words(self.language).map(|text| {
            let Certainties { parameters, determined, order_of_magnitude, open } = &certainties;
            for (at, count) in [
                ("determined", *determined),
                ("parameters", *parameters),
                ("order_of_magnitude", order_of_magnitude.len()),
                ("open", open.len()),
            ] {
                if count > 0 || matches!(at, "determined" | "parameters") {
                    self.number(&format!("/verdict/{at}"), count as f64, (1.0, 0, ""));
                }
            }
            format!(" ({text})")
        });
        let follows = self.follows(best).map(|fit| fill(phrases.follows, &[("fit", &fit)]));
        let of_two = kind == Kind::TwoVehicles;
        let predicts = self.predicts(best, of_two || first_is_decisive(concerns));
        let what = if of_two { Some(phrases.other_partner.to_owned()) } else { self.distrust(best, concerns) };
        let distrust = what.map(|what| fill(phrases.distrust, &[("what", &what)]));
        let texts = [
            ("model", candidate_name(&best.id)),
            ("determined", determined.unwrap_or_default()),
            ("follows", follows.unwrap_or_default()),
            ("predicts", predicts.unwrap_or_default()),
            ("distrust", distrust.unwrap_or_default()),
        ];
        Some(fill(phrases.use_model, &texts.each_ref().map(|(name, text)| (*name, text.as_str()))))
    }

    /// How closely a candidate follows the displacement.
    fn follows(&mut self, candidate: &CandidateResult) -> Option<String> {
        let place = self.run.candidates.iter().position(|other| other.id == candidate.id)?;
        let simulation = candidate.simulation.as_ref()?;
        let key = if simulation.fit_as_measured_percent.is_some() { "fit_as_measured_percent" } else { "fit_percent" };
        let at = format!("/candidates/{place}/simulation/{key}");
        Some(self.number(&at, candidate.fit_percent()?, (1.0, 1, "%")))
    }

    /// What it predicts: against a partner where one was asked for, else of the impacts on the wall one that was asked
    /// for before others, one within what was tested before one beyond, the slowest before faster ones. Within what was
    /// tested the model may be used, unless all of it is doubtful.
    fn predicts(&mut self, best: &CandidateResult, doubtful: bool) -> Option<String> {
        let (phrases, run) = (&self.language.phrases().conclusion, self.run);
        let of_best = || run.predictions.iter().enumerate().filter(|(_, p)| p.candidate == best.id);
        let crush = |(k, p): (usize, &'a PredictionV1)| Some((k, p, p.dynamic_crush_m?));
        let mm = (MILLI, 1, "mm");
        let of_crush = |text: &mut Self, (k, prediction, crush_m): (usize, &PredictionV1, f64)| {
            let at = format!("/predictions/{k}");
            let shown = text.number(&format!("{at}/dynamic_crush_m"), crush_m, mm);
            let mut intervals = prediction.intervals.iter().enumerate();
            let found = intervals.find(|(_, interval)| interval.name == "dynamic_crush_m");
            let interval = found.map(|(j, &PredictedIntervalV1 { low, high, level, .. })| {
                text.interval(&format!("{at}/intervals/{j}"), low, high, Some((100.0 * level).round() as u8), mm)
            });
            (shown, interval.unwrap_or_default())
        };
        if let Some(found) = of_best().filter(|(_, p)| p.collision.is_some()).find_map(crush) {
            let (crush, interval) = of_crush(self, found);
            let partner = found.1.partner.as_deref().unwrap_or_default();
            let texts = [("partner", partner), ("crush", &crush), ("interval", &interval)];
            return Some(fill(phrases.predicts_collision, &texts));
        }
        let found = of_best().filter(|(_, p)| p.partner.is_none()).filter_map(crush);
        let found = found.min_by(|(_, a, _), (_, b, _)| {
            let order = |p: &PredictionV1| (!run.asks_for(p), p.extrapolates);
            order(a).cmp(&order(b)).then(a.impact_speed_m_per_s.total_cmp(&b.impact_speed_m_per_s))
        })?;
        let (crush, interval) = of_crush(self, found);
        let at = format!("/predictions/{}/impact_speed_m_per_s", found.0);
        let speed = self.number(&at, found.1.impact_speed_m_per_s, (KM_PER_H_PER_M_PER_S, 1, "km/h"));
        let words = match (found.1.extrapolates, doubtful) {
            (true, _) => phrases.predicts_beyond,
            (false, true) => phrases.predicts,
            (false, false) => phrases.usable,
        };
        Some(fill(words, &[("crush", &crush), ("interval", &interval), ("speed", &speed)]))
    }

    /// The one thing to distrust before all others.
    fn distrust(&mut self, best: &CandidateResult, concerns: &[ConcernV1]) -> Option<String> {
        let phrases = &self.language.phrases().conclusion;
        if first_is_decisive(concerns) {
            return Some(phrases.decisive.to_owned());
        }
        if let Some(tests) = self.run.joint.as_ref().and_then(|joint| missed(joint, self.language)) {
            return Some(fill(self.language.phrases().joint.distrust, &[("tests", tests)]));
        }
        if let Some(open) = self.with_names(best, phrases.open_numbers, &best.record.undetermined()) {
            return Some(open);
        }
        if best.record.equivalent_to.is_some() {
            return Some(phrases.dual.to_owned());
        }
        self.with_names(best, phrases.hardly, &best.certainties().order_of_magnitude).or_else(|| {
            let beyond = self.run.predictions.iter().any(|p| p.candidate == best.id && p.extrapolates);
            let speed = beyond.then(|| self.impact_speed())??;
            Some(fill(phrases.extrapolates, &[("speed", &speed)]))
        })
    }

    /// A template with the names of some parameters in it, and the numbers in these names taken; nothing without any.
    fn with_names(&mut self, candidate: &CandidateResult, template: &str, names: &[&str]) -> Option<String> {
        let place = self.run.candidates.iter().position(|other| other.id == candidate.id)?;
        for (name, deflection_m) in names.iter().filter_map(|name| deflection_of_knot(&candidate.record, name)) {
            self.number(&format!("/candidates/{place}/parameters/{name}"), deflection_m, DEFLECTION);
        }
        (!names.is_empty()).then(|| fill(template, &[("names", &symbols(&candidate.record, names, self.language))]))
    }

    fn none_recommended(&mut self) -> String {
        let (phrases, run) = (&self.language.phrases().conclusion, self.run);
        let axis = run.channel().and_then(|channel| channel.axis).filter(|axis| *axis != Axis::X);
        let no_crush =
            run.events.as_ref().is_some_and(|events| events.dynamic_crush_m.is_none_or(|crush| crush <= 0.0));
        let because = match axis {
            Some(axis) => fill(phrases.other_axis, &[("axis", &axis.to_string())]),
            None if no_crush => phrases.no_crush.to_owned(),
            None => self.ranking.because.clone(),
        };
        let closest = run.recommendation.as_ref().and_then(|choice| choice.closest.as_deref());
        let closest = closest.and_then(|id| run.candidate(id)).and_then(|candidate| {
            let fit = self.follows(candidate)?;
            let place = run.candidates.iter().position(|other| other.id == candidate.id)?;
            let to_s = candidate.simulation.as_ref()?.to_s;
            let time = self.number(&format!("/candidates/{place}/simulation/to_s"), to_s, (MILLI, 1, "ms"));
            let texts = [("model", candidate_name(&candidate.id)), ("fit", fit), ("time", time)];
            Some(fill(phrases.closest, &texts.each_ref().map(|(name, text)| (*name, text.as_str()))))
        });
        fill(phrases.none_recommended, &[("because", &because), ("closest", &closest.unwrap_or_default())])
    }
}

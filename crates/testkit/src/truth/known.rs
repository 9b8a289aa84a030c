//! What is true of a run: known numbers, counts, fits, labels.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crumple_lumped::Model;
use serde_json::Value;

use crate::prediction_error::MadeCar;
use crate::records::LowPass;
use crate::truth::run::Made;

/// Sample interval, s, and number of the instants at which a model is moved: 0.3 s, beyond any rebound.
const DT_S: f64 = 1e-4;
const INSTANTS: usize = 3001;
/// Samples of rest before contact while a motion is filtered: 50 ms.
const REST: usize = 500;

/// What made a record.
#[derive(Debug, Clone)]
pub enum Maker {
    /// A lumped model, by its exact motion.
    Lumped(Model),
    /// A car of the testkit's own simulator.
    Car(MadeCar),
    /// A pulse of which the test as it was is known, and nothing at another speed or mass.
    Pulse(Impact),
    /// Something that nothing is asked of at another speed.
    Nothing,
}

/// What kind of record it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// A vehicle at a rigid wall.
    Vehicle,
    /// A vehicle that met another one.
    TwoVehicles,
    /// The table of an event data recorder.
    Recorder,
    /// A sensor in an occupant.
    Occupant,
    /// A vehicle whose pulse lies along another axis than that of the models.
    OtherAxis,
    /// Inputs and outputs, no crash.
    InputOutput,
}

/// The truth of a record.
#[derive(Debug, Clone)]
pub struct Known {
    /// What it is of.
    pub subject: Subject,
    /// What made it.
    pub maker: Maker,
    /// The true mass, kg.
    pub mass_kg: Option<f64>,
    /// The true impact speed, m/s.
    pub speed_m_per_s: Option<f64>,
    /// Whether the record states what is true, of a sensor that works: no fault is to be looked for.
    pub is_sound: bool,
    /// What the first or second warning has to name: the flag that makes the record right.
    pub remedy: Option<&'static str>,
    /// Sensors on the vehicle, each on another mass.
    pub sensors: usize,
    /// First contact on the time axis of the file, s.
    pub contact_s: f64,
}

/// A test as it would be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// Dynamic crush, m.
    pub crush_m: f64,
    /// Its time, s.
    pub time_s: f64,
    /// Speed of the rebound over that of the impact.
    pub restitution: f64,
    /// Largest deceleration behind CFC 60, m/s².
    pub peak_m_per_s2: f64,
}

impl Impact {
    /// A number of it by the name that records have for it.
    pub fn named(&self, name: &str, speed_m_per_s: f64) -> Option<f64> {
        match name {
            "dynamic_crush_m" => Some(self.crush_m),
            "time_of_dynamic_crush_s" => Some(self.time_s),
            "coefficient_of_restitution" => Some(self.restitution),
            "peak_acceleration_m_per_s2" => Some(self.peak_m_per_s2),
            "delta_v_m_per_s" => Some(speed_m_per_s * (1.0 + self.restitution)),
            _ => None,
        }
    }
}

impl Known {
    /// A vehicle that a record states rightly.
    pub fn vehicle(maker: Maker, mass_kg: f64, speed_m_per_s: f64) -> Self {
        Self {
            subject: Subject::Vehicle,
            maker,
            mass_kg: Some(mass_kg),
            speed_m_per_s: Some(speed_m_per_s),
            is_sound: true,
            remedy: None,
            sensors: 1,
            contact_s: 0.0,
        }
    }

    /// A record of which nothing is known but what it is of.
    pub fn of(subject: Subject) -> Self {
        Self {
            subject,
            maker: Maker::Nothing,
            mass_kg: None,
            speed_m_per_s: None,
            is_sound: true,
            remedy: None,
            sensors: 1,
            contact_s: 0.0,
        }
    }

    /// The name of the model that made it.
    pub fn model(&self) -> Option<&'static str> {
        match &self.maker {
            Maker::Lumped(model) => Some(model.kind().name()),
            _ => None,
        }
    }

    /// The impact at a speed, m/s, with a mass, kg: what is added sits in the compartment. `None` where the car is not
    /// known or does not stop.
    pub fn impact(&self, speed_m_per_s: f64, mass_kg: f64) -> Option<Impact> {
        let own_kg = self.mass_kg?;
        match &self.maker {
            Maker::Nothing => None,
            // The speed that the record states is up to 1 % off.
            Maker::Pulse(impact) => {
                let own = self.speed_m_per_s?;
                ((speed_m_per_s - own).abs() <= 0.01 * own && mass_kg == own_kg).then_some(*impact)
            }
            Maker::Car(car) => {
                let [crush_m, time_s, restitution, peak_m_per_s2] = car.impact(speed_m_per_s, mass_kg / own_kg);
                Some(Impact { crush_m, time_s, restitution, peak_m_per_s2 })
            }
            Maker::Lumped(model) => {
                let model = with_mass(model, mass_kg - own_kg)?;
                let response = model.respond(speed_m_per_s, DT_S, INSTANTS).ok()?;
                let motion = response.compartment();
                let rebound = motion.velocity_m_per_s.iter().fold(0.0_f64, |lowest, v| lowest.min(*v));
                let events = model.events(speed_m_per_s).ok()?;
                Some(Impact {
                    crush_m: events.dynamic_crush_m?,
                    time_s: events.time_of_dynamic_crush_s?,
                    restitution: -rebound / speed_m_per_s,
                    peak_m_per_s2: peak_behind_cfc_60(&motion.acceleration_m_per_s2),
                })
            }
        }
    }
}

/// Largest deceleration behind CFC 60, m/s².
fn peak_behind_cfc_60(acceleration: &[f64]) -> f64 {
    let wave = std::iter::repeat_n(0.0, REST).chain(acceleration.iter().copied());
    LowPass::of_class(60.0).both_ways(wave, DT_S).iter().fold(0.0, |peak, a| peak.max(-a))
}

/// A model with more mass in its compartment.
fn with_mass(model: &Model, more_kg: f64) -> Option<Model> {
    let mut parameters = model.parameters();
    let last = ["m3_kg", "m2_kg", "mass_kg"].into_iter().find(|name| parameters.contains_key(*name))?;
    *parameters.get_mut(last)? += more_kg;
    Model::from_parameters(model.kind(), &parameters).ok()
}

/// Counts by quantity: intervals, and those that hold the truth.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Counts(BTreeMap<(&'static str, String), (usize, usize)>);

/// Nominal level of all of them.
const LEVEL: f64 = 0.9;
/// Standard deviations of the binomial count by which it may be lower; one in a thousand counts is.
const ALLOWANCE: f64 = 3.1;

impl Counts {
    /// Counts an interval of what `kind` has of a quantity.
    pub fn add(&mut self, kind: &'static str, quantity: &str, holds: bool) {
        let (all, held) = self.0.entry((kind, quantity.to_owned())).or_default();
        *all += 1;
        *held += usize::from(holds);
    }

    /// Quantities that hold the truth less often than their level says, chance allowed for.
    pub fn too_low(&self) -> Vec<String> {
        let is_low = |all: usize, held: usize| {
            let all = all as f64;
            (held as f64) < LEVEL * all - ALLOWANCE * (all * LEVEL * (1.0 - LEVEL)).sqrt()
        };
        let low = self.0.iter().filter(|(_, (all, held))| is_low(*all, *held));
        low.map(|((kind, quantity), (all, held))| format!("{kind} {quantity}: {held} of {all} intervals hold"))
            .collect()
    }

    /// Lines of a table: of what, quantity, how many of how many.
    pub fn table(&self) -> String {
        let mut out = "\n| 90 % intervals | quantity | hold the truth |\n|---|---|---|\n".to_owned();
        for ((kind, quantity), (all, held)) in &self.0 {
            let _infallible = writeln!(out, "| {kind} | {quantity} | {held} of {all} |");
        }
        out
    }
}

/// `100 (1 - |x - y| / |x - mean x|)`, percent, of the displacement of the record, x, and of a candidate, y, over the
/// window that its simulation was compared in, at the instants of the record. `None` without one of the waves.
pub fn fit_percent(made: &Made, candidate: &str) -> Option<f64> {
    let simulation = &made.candidate(candidate)?["simulation"];
    let (from_s, to_s) = (simulation["from_s"].as_f64()?, simulation["to_s"].as_f64()?);
    let channel = made.summary.pointer("/events/channel")?.as_str()?;
    let record = made.waves.get(&format!("{channel}/displacement"))?.sampled.clone();
    let model = made.waves.get(&format!("{candidate}/displacement"))?.sampled.clone();
    let window = (0..record.len()).map(|k| record.t0_s() + k as f64 * record.dt_s());
    let pairs: Vec<(f64, f64)> = window
        .zip(record.samples())
        .filter(|(time_s, _)| (from_s - 1e-9..=to_s + 1e-9).contains(time_s))
        .filter_map(|(time_s, x)| Some((*x, model.at(time_s)?)))
        .collect();
    let mean = pairs.iter().map(|(x, _)| x).sum::<f64>() / pairs.len() as f64;
    let [misfit, spread] = [
        pairs.iter().map(|(x, y)| (x - y).powi(2)).sum::<f64>(),
        pairs.iter().map(|(x, _)| (x - mean).powi(2)).sum::<f64>(),
    ];
    (spread > 0.0).then(|| 100.0 * (1.0 - (misfit / spread).sqrt()))
}

/// Subjects of `phrases` that none of the surfaces shows: they stand below the first screen, on other pages, or in
/// another program.
pub const ELSEWHERE: &[(&str, &str)] = &[
    ("figures", "axes, legends and captions of figures"),
    ("identification", "section of the identified models, below the first screen of a crash"),
    ("joint", "one model of several tests: said by just together, not by a run"),
    ("candidates", "table of all candidates, below the first screen"),
    ("how_well", "tables of ratings and energy, below the first screen"),
    ("predictions", "table of predictions, below the first screen"),
    ("runs", "pages of several runs"),
    ("fleet", "pages of a fleet"),
    ("cursor", "what the script of the figures says when somebody points"),
    ("what_if", "the sliders"),
];

/// Texts that name what stands beside them and claim nothing.
pub const LABELS: &[&str] = &[
    "conclusion.no_mode",
    "page.brand",
    "page.brand_generic",
    "page.untitled",
    "page.vehicle",
    "page.test_mass",
    "page.impact_speed",
    "page.barrier",
    "page.channel_taken",
    "page.sampling",
    "page.axis",
    "page.to",
    "page.yes",
    "page.no",
    "numbers.key_numbers",
    "numbers.motion_over_ground",
    "numbers.peak_cfc",
    "numbers.peak_filtered",
    "numbers.inputs",
    "numbers.resolution",
    "numbers.interval",
    "numbers.olc",
    "numbers.hic",
    "model.title",
    "model.caption",
    "conclusion.verdict",
    "conclusion.level",
    "conclusion.about_record",
    "conclusion.about_model",
    "conclusion.about_predictions",
    "conclusion.about_occupants",
    "conclusion.about_wall_force",
    "conclusion.about_identified_models",
    "conclusion.ground_label",
    "conclusion.model_label",
    "conclusion.explains",
    "conclusion.warnings_label",
    "conclusion.missing_label",
    "conclusion.files_label",
    "conclusion.failed_label",
    "conclusion.doubtful_label",
    "conclusion.and",
    "conclusion.given",
    "conclusion.read_the_notes",
    "conclusion.curve",
    "conclusion.as_one_spring",
    "conclusion.over_sensors",
];

/// Texts of a subject of runs that no run can print, each with its reason.
pub const NOT_OF_A_RUN: &[(&str, &str)] = &[
    ("conclusion.because_tests_disagree", "one model of several tests: said by just together"),
    (
        "conclusion.because_other_axis",
        "a record that another program wrote: ingest doubts such a pulse, which goes first",
    ),
    ("conclusion.other_axis", "as the reason of the status"),
];

/// Subjects of which only the texts with a rule stand on the surfaces; the others stand below the first screen.
pub const BELOW: &[(&str, &str)] = &[
    ("page", "words of every table, and the channels"),
    ("numbers", "tables of events and metrics"),
    ("model", "words in the drawing of a model, which are its parameters"),
    ("remarks", "notes, limits and provenance"),
];

/// Quantities of a prediction.
const PREDICTED: [&str; 5] = [
    "dynamic_crush_m",
    "time_of_dynamic_crush_s",
    "peak_acceleration_m_per_s2",
    "coefficient_of_restitution",
    "delta_v_m_per_s",
];

/// Words that belong to the status *usable* alone.
const USABLE: [&str; 4] = ["may be used", "is usable", "are usable", "reliable"];

/// What is wrong: the number and why. Intervals are counted.
pub fn check_numbers(made: &Made, counts: &mut Counts) -> Vec<(String, String)> {
    let mut wrong = Vec::new();
    intervals(made, counts);
    wrong.extend(poles(made));
    wrong.extend(usable_words(made));
    wrong.extend(question(made));
    wrong.extend(remedy(made));
    wrong.extend(record(made));
    wrong
}

/// Counts the intervals of a sound record: of its events, and of what the recommended model predicts.
fn intervals(made: &Made, counts: &mut Counts) {
    let known = &made.known;
    let (Some(speed), Some(mass)) = (known.speed_m_per_s, known.mass_kg) else { return };
    if !known.is_sound || !made.is_of_a_vehicle() {
        return;
    }
    let holds = |interval: &Value, truth: f64| {
        let ends = interval["low"].as_f64().zip(interval["high"].as_f64());
        ends.map(|(low, high)| (low..=high).contains(&truth))
    };
    if let Some(truth) = known.impact(speed, mass) {
        for interval in made.list("/events/intervals") {
            let name = interval["name"].as_str().unwrap_or_default();
            let value = truth.named(name, speed).filter(|_| !name.starts_with("peak"));
            if let Some(holds) = value.and_then(|value| holds(interval, value)) {
                counts.add("of the test", name, holds);
            }
        }
    }
    let of_best = made.list("/predictions").iter().filter(|p| p["recommended"] == true && p["partner"].is_null());
    for prediction in of_best {
        let asked = prediction["impact_speed_m_per_s"].as_f64().zip(prediction["mass_kg"].as_f64());
        let Some((speed, mass)) = asked else { continue };
        let Some(truth) = known.impact(speed, mass) else { continue };
        for interval in prediction["intervals"].as_array().into_iter().flatten() {
            let name = interval["name"].as_str().unwrap_or_default();
            let value = truth.named(name, speed).filter(|_| PREDICTED.contains(&name));
            if let Some(holds) = value.and_then(|value| holds(interval, value)) {
                counts.add("of predictions", name, holds);
            }
        }
    }
}

/// A mode oscillates below half of the sampling rate; poles that are called stable do not grow.
fn poles(made: &Made) -> Vec<(String, String)> {
    let Some(rate) = made.number("/test/sample_rate_hz") else { return Vec::new() };
    let mut wrong = Vec::new();
    for model in made.list("/models") {
        let id = model["id"].as_str().unwrap_or_default();
        for mode in model["modes"].as_array().into_iter().flatten() {
            let hz = mode["natural_frequency_rad_per_s"].as_f64().unwrap_or_default() / std::f64::consts::TAU;
            let im = mode["im_rad_per_s"].as_f64().unwrap_or_default();
            if im != 0.0 && hz > 0.5 * rate * (1.0 + 1e-9) {
                wrong.push((format!("{id} modes"), format!("a mode of {hz:.0} Hz at {rate:.0} samples a second")));
            }
        }
    }
    let growing = |pole: &&Value| pole["re_per_s"].as_f64().is_some_and(|re| re > 1e-9);
    let all = made.list("/models").iter().flat_map(|model| model["poles"].as_array().into_iter().flatten());
    let count = all.filter(growing).count();
    if count > 0 && made.captions.contains("All poles are stable.") {
        wrong.push(("poles".to_owned(), format!("\"All poles are stable\" beside {count} that grow")));
    }
    wrong
}

/// What the status *usable* says, nothing else says.
fn usable_words(made: &Made) -> Vec<(String, String)> {
    let sentences = made.list("/verdict/sentences").iter().filter_map(Value::as_str).map(str::to_owned);
    let concerns = made.concerns().map(str::to_owned);
    let page = made.page.iter().filter(|block| !block.section.contains("status")).map(|block| block.text.clone());
    let all = sentences.chain(concerns).chain(page).chain(made.console.iter().cloned());
    let says = |text: String| {
        let text = text.to_lowercase().replace("unreliable", "");
        let word = USABLE.iter().find(|word| text.contains(**word))?;
        Some(("word".to_owned(), format!("{word:?} stands in {text:?}")))
    };
    all.filter_map(says).collect()
}

/// What was asked is predicted: this speed, this mass, this partner.
fn question(made: &Made) -> Option<(String, String)> {
    let question = made.question?;
    made.recommended()?;
    let answer = crate::truth::rules::answer(made);
    answer.is_none().then(|| ("predictions".to_owned(), format!("{:?} is not answered", question.flags)))
}

/// A record that states what is true is not called wrong; one that a flag makes right is not called sound.
fn record(made: &Made) -> Option<(String, String)> {
    let said = made.text("/verdict/record");
    let is_false = (made.known.is_sound && said == "wrong") || (made.known.remedy.is_some() && said == "sound");
    is_false.then(|| ("record".to_owned(), format!("it is called {said}")))
}

/// The first or second warning names what would make a wrong record right.
fn remedy(made: &Made) -> Option<(String, String)> {
    let remedy = made.known.remedy?;
    let first: Vec<&Value> = made.list("/concerns").iter().take(2).collect();
    let names = |concern: &&Value| {
        [&concern["text"], &concern["remedy"]]
            .iter()
            .any(|text| text.as_str().is_some_and(|text| text.contains(remedy)))
    };
    let texts = || first.iter().filter_map(|concern| concern["text"].as_str()).collect::<Vec<_>>().join("; ");
    (!first.iter().any(names)).then(|| ("warnings".to_owned(), format!("{remedy} is not named by: {}", texts())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_is_allowed_for() {
        let mut counts = Counts::default();
        for k in 0..40 {
            counts.add("of a test", "enough", k % 5 != 0);
            counts.add("of a test", "few", k % 3 != 0);
        }
        assert_eq!(counts.too_low(), ["of a test few: 26 of 40 intervals hold"]);
    }
}

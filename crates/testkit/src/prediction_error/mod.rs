//! How far predictions of other tests are off: cars that no family equals, tested once as a laboratory does, asked at
//! other speeds and masses through the programs.

use std::collections::BTreeMap;
use std::path::Path;

use rayon::prelude::*;
use serde_json::Value;

use crate::prediction_error::car::{Car, Truth};
use crate::prediction_error::kind::TESTED_KM_PER_H;
use crate::prediction_error::score::{ASKED, LOWER, OWN_TEST, scored, scored_truth};
use crate::programs::{StepError, Steps, records};
use crate::records::Measurement;

pub use crate::prediction_error::kind::{KINDS, Kind};
pub use crate::prediction_error::score::{Answer, Outcome, Prediction, tables};

mod car;
mod kind;
mod score;

/// A car of a kind, that is asked what a test would show.
#[derive(Debug, Clone)]
pub struct MadeCar {
    car: Car,
    /// The speed of its own test, m/s.
    pub speed_m_per_s: f64,
}

/// The car of a number, with the record of its own test, as CSV.
pub(crate) fn made(kind: &Kind, number: usize) -> (String, MadeCar) {
    let (car, speed_m_per_s) = (kind.car(number), kind.speed_factor() * TESTED_KM_PER_H / 3.6);
    (record(&car, speed_m_per_s, 0), MadeCar { car, speed_m_per_s })
}

impl MadeCar {
    /// Crush, m, its time, s, restitution and peak behind CFC 60, m/s², of an impact at a speed, m/s, with the mass
    /// changed by a factor.
    pub fn impact(&self, speed_m_per_s: f64, mass_factor: f64) -> [f64; 4] {
        let truth = self.car.truth(speed_m_per_s, mass_factor);
        [truth.crush_m, truth.time_s, truth.restitution, truth.peak_m_per_s2]
    }

    /// Its mass, kg.
    pub fn mass_kg(&self) -> f64 {
        self.car.mass_kg()
    }
}

/// Random numbers between the first of one test and of the next: more than one test draws.
const OF_ONE_TEST: usize = 20_000;

/// The record of an impact at a stated `speed`, m/s, as CSV. Tests of other numbers have other errors.
pub(crate) fn record(car: &Car, speed: f64, number: usize) -> String {
    let mut random = car.random.clone();
    for _ in 0..number * OF_ONE_TEST {
        let _of_an_earlier_test = random.uniform();
    }
    let measurement = Measurement::drawn(&mut random, false);
    let motion = car.test(speed + measurement.speed_error_m_per_s, 1.0);
    let head = format!(
        "# title: made for a trial of predictions\n# mass: {} kg\n# impact speed: {} km/h\n",
        car.mass_kg(),
        speed * 3.6
    );
    measurement.csv(&head, &[("accel", &motion.acceleration)], &mut random)
}

/// Cars of these kinds and numbers, through the programs in `bin` with the pipeline in `pipeline`.
///
/// `tests`: speeds at which each is tested, km/h; with several, one model is fitted to all of them. `candidates`: what
/// every candidate predicts too, for as much time again. Every car leaves its records and artifacts in a folder of its
/// own below that of its kind. A car and its noise follow from its kind and number alone. Errors: a program that is
/// missing or fails.
pub fn outcomes(
    kinds: &[&Kind],
    numbers: &std::ops::Range<usize>,
    (tests, candidates): (&[f64], bool),
    (bin, pipeline): (&Path, &Path),
    folder: &Path,
) -> Result<Vec<Outcome>, StepError> {
    let cars: Vec<(&Kind, usize)> =
        kinds.iter().flat_map(|kind| numbers.clone().map(move |number| (*kind, number))).collect();
    let trial_of = |(kind, number): (&Kind, usize)| {
        let folder = folder.join(kind.name.replace([',', ' ', '/'], "-")).join(number.to_string());
        trial(kind, number, (tests, candidates), &Steps { bin, folder: &folder, pipeline: Some(pipeline) })
    };
    cars.into_par_iter().map(trial_of).collect()
}

/// A car, the programs, and what they are given to predict from.
struct Trial<'a> {
    programs: &'a Steps<'a>,
    inputs: &'a [&'a str],
    mass_kg: f64,
    speed_factor: f64,
    truths: Vec<Truth>,
}

impl Trial<'_> {
    /// Records of predictions at some speeds, km/h, and a factor of the mass, by a candidate or those that are chosen.
    fn predicted(&self, speeds: &[f64], mass_factor: f64, candidate: Option<&str>) -> Result<Vec<Value>, StepError> {
        let speeds: Vec<String> = speeds.iter().map(|speed| format!("{}km/h", self.speed_factor * speed)).collect();
        let (speeds, mass) = (speeds.join(","), format!("{}kg", self.mass_kg * mass_factor));
        let mut arguments = self.inputs.to_vec();
        arguments.extend(["--json", "--force", "-o", "7.mcap", "--speed", &speeds, "--mass", &mass]);
        arguments.extend(candidate.iter().flat_map(|id| ["--candidate", id]));
        let printed = self.programs.run("predict", &arguments)?;
        Ok(records(&printed, "/prediction/").map(|(_, record)| record).collect())
    }

    /// The same at every speed and mass that is asked for.
    fn all_predicted(&self, candidate: Option<&str>) -> Result<Vec<Value>, StepError> {
        let mut answers = Vec::new();
        for factor in [1.0, 0.8, 1.2] {
            let speeds: Vec<f64> = ASKED.iter().filter(|asked| asked.1 == factor).map(|asked| asked.0).collect();
            answers.extend(self.predicted(&speeds, factor, candidate)?);
        }
        Ok(answers)
    }

    /// The answers in the order in which they are asked, beside the truth.
    fn scored(&self, answers: &[Value]) -> Vec<Option<Prediction>> {
        let near = |value: &Value, wanted: f64| value.as_f64().is_some_and(|value| (value / wanted - 1.0).abs() < 1e-6);
        let answer = |(speed, factor): (f64, f64)| {
            answers.iter().find(|answer| {
                near(&answer["impact_speed_m_per_s"], self.speed_factor * speed / 3.6)
                    && near(&answer["mass_kg"], self.mass_kg * factor)
            })
        };
        ASKED.iter().zip(&self.truths).map(|(asked, truth)| Some(scored(answer(*asked)?, truth))).collect()
    }

    /// Status of the run, asked at the lower speed.
    fn status(&self) -> Result<Option<String>, StepError> {
        self.predicted(&[ASKED[LOWER].0], 1.0, None)?;
        let artifacts = ["1", "2", "3", "4", "5", "6"].map(|stage| format!("0/{stage}.mcap"));
        let mut arguments: Vec<&str> = artifacts.iter().map(String::as_str).collect();
        arguments.extend(["7.mcap", "-o", "report.html", "--summary", "summary.json", "--json"]);
        let summary: Value = serde_json::from_str(&self.programs.run("report", &arguments)?).unwrap_or_default();
        let status = ["conclusion", "verdict"].iter().find_map(|key| summary[key]["status"].as_str());
        Ok(status.map(str::to_owned))
    }
}

/// Records the tests of a car and solves for its models: what the solver printed.
fn solved(car: &Car, tests: &[f64], programs: &Steps<'_>) -> Result<String, StepError> {
    let mut of_all: Vec<String> = Vec::new();
    for (k, km_per_h) in tests.iter().enumerate() {
        let [crash, raw, filtered, integrated] =
            ["crash.csv", "1.mcap", "2.mcap", "3.mcap"].map(|f| format!("{k}/{f}"));
        programs.write(&crash, &record(car, km_per_h / 3.6, k))?;
        programs.run("ingest", &[&crash, "--time-zero", "0s", "-o", &raw])?;
        programs.run("filter", &[&raw, "-o", &filtered])?;
        programs.run("integrate", &[&filtered, "-o", &integrated])?;
        of_all.extend([filtered, integrated].map(|path| format!("{k}:{path}")));
    }
    if tests.len() > 1 {
        let mut arguments: Vec<&str> = of_all.iter().map(String::as_str).collect();
        arguments.extend(["--json", "-o", "0/5.mcap"]);
        return programs.run("parameter-solve", &arguments);
    }
    programs.run("identify", &["0/2.mcap", "0/3.mcap", "-o", "0/4.mcap"])?;
    let solved = programs.run("parameter-solve", &["0/2.mcap", "0/3.mcap", "0/4.mcap", "--json", "-o", "0/5.mcap"])?;
    programs.run("simulate", &["0/2.mcap", "0/3.mcap", "0/5.mcap", "-o", "0/6.mcap"])?;
    Ok(solved)
}

fn trial(
    kind: &Kind,
    number: usize,
    (tests, candidates): (&[f64], bool),
    programs: &Steps<'_>,
) -> Result<Outcome, StepError> {
    let car = kind.car(number);
    let speed_factor = kind.speed_factor();
    let tests: Vec<f64> = tests.iter().map(|km_per_h| speed_factor * km_per_h).collect();
    let solved = solved(&car, &tests, programs)?;
    // The first candidate of each model and method.
    let mut first: BTreeMap<String, String> = BTreeMap::new();
    for (id, _) in records(&solved, "/parameters/") {
        let method = id.rsplit_once('/').map_or(id.as_str(), |(method, _)| method).to_owned();
        first.entry(method).or_insert(id);
    }
    let recommendation = records(&solved, "/recommendation").next().map(|(_, record)| record).unwrap_or_default();
    let recommended = recommendation["recommended"].as_str();
    let truths_of = |car: &Car| -> Vec<Truth> {
        ASKED.iter().map(|(speed, factor)| car.truth(speed_factor * speed / 3.6, *factor)).collect()
    };
    let inputs: &[&str] = if tests.len() > 1 { &["0/5.mcap"] } else { &["0/3.mcap", "0/5.mcap"] };
    let trial = Trial { programs, inputs, mass_kg: car.mass_kg(), speed_factor, truths: truths_of(&car) };
    let status = if tests.len() > 1 { None } else { trial.status()? };
    let mut answers = trial.all_predicted(None)?;
    answers.retain(|answer| answer["recommended"] == true);
    let known = truths_of(&car.known_from(tests.iter().map(|km_per_h| km_per_h / 3.6)));
    let known = known.iter().zip(&trial.truths).map(|(known, truth)| Some(scored_truth(known, truth)));
    let (lower, own) = (&trial.truths[LOWER], &trial.truths[OWN_TEST]);
    let mut outcome = Outcome {
        kind: kind.name,
        number,
        lower_ratios: [lower.crush_m / own.crush_m, lower.peak_m_per_s2 / own.peak_m_per_s2],
        recommended: recommended.map(|id| id.rsplit_once('/').map_or(id, |(method, _)| method).to_owned()),
        status,
        predictions: vec![(Answer::Recommended, trial.scored(&answers)), (Answer::CarItself, known.collect())],
    };
    for (method, id) in first.into_iter().filter(|_| candidates) {
        let answers = trial.all_predicted(Some(&id))?;
        outcome.predictions.push((Answer::Candidate(method), trial.scored(&answers)));
    }
    Ok(outcome)
}

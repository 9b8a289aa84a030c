//! One car through the programs: its record in, predictions out.

use std::collections::BTreeMap;
use std::path::Path;

use rayon::prelude::*;
use serde_json::Value;

use super::car::{Car, Truth};
use super::kind::Kind;
use super::record::record;
use super::score::{ASKED, Answer, Outcome, Prediction};
use crate::programs::steps::{StepError, Steps, records};

/// Cars of a kind, those of the numbers given, through the programs in `bin` with the pipeline in `pipeline`.
///
/// `tests`: speeds at which each is tested, km/h; with several, one model is fitted to all of them. Every car leaves
/// its records and artifacts in a folder of its own. A car and its noise follow from its kind and number alone. Errors:
/// a program that is missing or fails.
pub fn outcomes(
    kind: &Kind,
    numbers: std::ops::Range<usize>,
    tests: &[f64],
    (bin, pipeline): (&Path, &Path),
    folder: &Path,
) -> Result<Vec<Outcome>, StepError> {
    numbers
        .into_par_iter()
        .map(|number| {
            let folder = folder.join(number.to_string());
            let programs = Steps { bin, folder: &folder, pipeline: Some(pipeline) };
            trial(kind, number, tests, &programs)
        })
        .collect()
}

/// Predictions at every speed and mass that is asked for, by a candidate or by the one that is recommended.
fn predictions(
    programs: &Steps<'_>,
    inputs: &[&str],
    candidate: Option<&str>,
    mass_kg: f64,
) -> Result<Vec<Value>, StepError> {
    let mut answers = Vec::new();
    for factor in [1.0, 0.8, 1.25] {
        let speeds: Vec<String> =
            ASKED.iter().filter(|asked| asked.1 == factor).map(|asked| format!("{}km/h", asked.0)).collect();
        let (speeds, mass) = (speeds.join(","), format!("{}kg", mass_kg * factor));
        let mut arguments = inputs.to_vec();
        arguments.extend(["--json", "--force", "-o", "7.mcap", "--speed", &speeds, "--mass", &mass]);
        arguments.extend(candidate.iter().flat_map(|id| ["--candidate", id]));
        answers.extend(records(&programs.run("predict", &arguments)?, "/prediction/").map(|(_, data)| data));
    }
    Ok(answers)
}

fn trial(kind: &Kind, number: usize, tests: &[f64], programs: &Steps<'_>) -> Result<Outcome, StepError> {
    let car = kind.car(number);
    let mut of_all: Vec<String> = Vec::new();
    for (k, km_per_h) in tests.iter().enumerate() {
        let [crash, raw, filtered, integrated] =
            ["crash.csv", "1.mcap", "2.mcap", "3.mcap"].map(|f| format!("{k}/{f}"));
        programs.write(&crash, &record(&car, km_per_h / 3.6, k))?;
        programs.run("ingest", &[&crash, "--time-zero", "0s", "-o", &raw])?;
        programs.run("filter", &[&raw, "-o", &filtered])?;
        // A made record begins when it says and has no error of gain; its zero level is off.
        let exact = ["--gain-uncertainty", "0 % uniform", "--time-zero-uncertainty", "0 s uniform"];
        programs.run("integrate", &[&[filtered.as_str(), "-o", &integrated], &exact[..]].concat())?;
        of_all.extend([filtered, integrated].map(|path| format!("{k}:{path}")));
    }
    let (mut arguments, inputs) = if let [_] = tests {
        programs.run("identify", &["0/2.mcap", "0/3.mcap", "-o", "4.mcap"])?;
        (vec!["0/2.mcap", "0/3.mcap", "4.mcap"], &["0/3.mcap", "5.mcap"][..])
    } else {
        (of_all.iter().map(String::as_str).collect(), &["5.mcap"][..])
    };
    arguments.extend(["--json", "-o", "5.mcap"]);
    let solved = programs.run("parameter-solve", &arguments)?;
    // The first candidate of each model and method.
    let mut first: BTreeMap<String, String> = BTreeMap::new();
    for (id, _) in records(&solved, "/parameters/") {
        let method = id.rsplit_once('/').map_or(id.as_str(), |(method, _)| method).to_owned();
        first.entry(method).or_insert(id);
    }
    let truths: Vec<Truth> = ASKED.iter().map(|(speed, factor)| car.truth(speed / 3.6, *factor)).collect();
    let mass_kg = car.mass_kg();
    let mut answers: Vec<Value> = predictions(programs, inputs, None, mass_kg)?;
    answers.retain(|answer| answer["recommended"] == true);
    let recommended = answers.first().and_then(|answer| answer["candidate"].as_str());
    let mut outcome = Outcome {
        kind: kind.name,
        number,
        recommended: recommended.map(|id| id.rsplit_once('/').map_or(id, |(method, _)| method).to_owned()),
        predictions: vec![
            (Answer::Recommended, scored(&answers, mass_kg, &truths)),
            (Answer::CarItself, of_the_car(&car.known_from(tests.iter().map(|km_per_h| km_per_h / 3.6)), &truths)),
        ],
    };
    for (method, id) in first {
        let answers = predictions(programs, inputs, Some(&id), mass_kg)?;
        outcome.predictions.push((Answer::Candidate(method), scored(&answers, mass_kg, &truths)));
    }
    Ok(outcome)
}

/// What a car that is known so far answers, beside the truth.
fn of_the_car(known: &Car, truths: &[Truth]) -> Vec<Option<Prediction>> {
    let answer = |((speed, factor), truth): (&(f64, f64), &Truth)| {
        let known = known.truth(speed / 3.6, *factor);
        Some(Prediction {
            crush: known.crush_m / truth.crush_m - 1.0,
            time: known.time_s / truth.time_s - 1.0,
            peak: Some(known.peak_m_per_s2 / truth.peak_m_per_s2 - 1.0),
            restitution: Some(known.restitution - truth.restitution),
            interval: None,
        })
    };
    ASKED.iter().zip(truths).map(answer).collect()
}

/// The answers in the order in which they are asked, beside the truth.
fn scored(answers: &[Value], mass_kg: f64, truths: &[Truth]) -> Vec<Option<Prediction>> {
    let answer = |(speed, factor): (f64, f64), truth: &Truth| -> Option<Prediction> {
        let near = |value: &Value, wanted: f64| value.as_f64().is_some_and(|value| (value / wanted - 1.0).abs() < 1e-6);
        let answer = answers.iter().find(|answer| {
            near(&answer["impact_speed_m_per_s"], speed / 3.6) && near(&answer["mass_kg"], mass_kg * factor)
        })?;
        let interval = answer["intervals"].as_array().into_iter().flatten().find(|i| i["name"] == "dynamic_crush_m");
        let interval = interval.and_then(|i| {
            let (low, high) = (i["low"].as_f64()?, i["high"].as_f64()?);
            Some((low <= truth.crush_m && truth.crush_m <= high, (high - low) / truth.crush_m))
        });
        Some(Prediction {
            crush: answer["dynamic_crush_m"].as_f64()? / truth.crush_m - 1.0,
            time: answer["time_of_dynamic_crush_s"].as_f64()? / truth.time_s - 1.0,
            peak: answer["peak_acceleration_m_per_s2"].as_f64().map(|peak| peak.abs() / truth.peak_m_per_s2 - 1.0),
            restitution: answer["coefficient_of_restitution"].as_f64().map(|e| e - truth.restitution),
            interval,
        })
    };
    ASKED.iter().zip(truths).map(|(asked, truth)| answer(*asked, truth)).collect()
}

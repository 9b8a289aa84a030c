//! One car through the programs: its record in, predictions out.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use rayon::prelude::*;
use serde_json::Value;

use super::car::Truth;
use super::kind::Kind;
use super::record::record;
use super::score::{ASKED, Answer, Outcome, Prediction};

/// Why a car could not be tried.
#[derive(Debug)]
pub enum TrialError {
    /// A program did not start, or a file could not be written.
    File(PathBuf, io::Error),
    /// A program ended badly on a good record.
    Program(String),
}

impl std::fmt::Display for TrialError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(path, error) => write!(f, "{}: {error}", path.display()),
            Self::Program(said) => f.write_str(said),
        }
    }
}

impl std::error::Error for TrialError {}

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
) -> Result<Vec<Outcome>, TrialError> {
    numbers
        .into_par_iter()
        .map(|number| {
            let folder = folder.join(number.to_string());
            let programs = Programs { bin, pipeline, folder: &folder };
            trial(kind, number, tests, &programs)
        })
        .collect()
}

/// The programs, and the folder in which they work.
struct Programs<'a> {
    bin: &'a Path,
    pipeline: &'a Path,
    folder: &'a Path,
}

impl Programs<'_> {
    /// Runs a stage; what it prints. Errors: it does not start, or ends with another code than 0 or 4 (no acceptable
    /// result, which is an answer).
    fn step(&self, program: &str, arguments: &[&str]) -> Result<String, TrialError> {
        let path = self.bin.join(format!("crumple-{program}"));
        let output = Command::new(&path)
            .args(arguments)
            .arg("-q")
            .arg("--pipeline")
            .arg(self.pipeline)
            .current_dir(self.folder)
            .env("RAYON_NUM_THREADS", "1")
            .output()
            .map_err(|error| TrialError::File(path, error))?;
        match output.status.code() {
            Some(0 | 4) => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
            _ => Err(TrialError::Program(format!(
                "crumple-{program} {} in {}: {}",
                arguments.join(" "),
                self.folder.display(),
                String::from_utf8_lossy(&output.stderr)
            ))),
        }
    }

    /// Predictions at every speed and mass that is asked for, by a candidate or by the one that is recommended.
    fn predictions(&self, inputs: &[&str], candidate: Option<&str>, mass_kg: f64) -> Result<Vec<Value>, TrialError> {
        let mut answers = Vec::new();
        for factor in [1.0, 0.8, 1.25] {
            let speeds: Vec<String> =
                ASKED.iter().filter(|asked| asked.1 == factor).map(|asked| format!("{}km/h", asked.0)).collect();
            let (speeds, mass) = (speeds.join(","), format!("{}kg", mass_kg * factor));
            let mut arguments = inputs.to_vec();
            arguments.extend(["--json", "--force", "-o", "7.mcap", "--speed", &speeds, "--mass", &mass]);
            arguments.extend(candidate.iter().flat_map(|id| ["--candidate", id]));
            answers.extend(records(&self.step("predict", &arguments)?, "/prediction/").map(|(_, data)| data));
        }
        Ok(answers)
    }
}

/// Records below a topic in what a stage printed: rest of the topic, data.
fn records(printed: &str, below: &str) -> impl Iterator<Item = (String, Value)> {
    printed.lines().filter_map(move |line| {
        let mut record: Value = serde_json::from_str(line).ok()?;
        let rest = record["topic"].as_str()?.strip_prefix(below)?.to_owned();
        Some((rest, record["data"].take()))
    })
}

fn trial(kind: &Kind, number: usize, tests: &[f64], programs: &Programs<'_>) -> Result<Outcome, TrialError> {
    let car = kind.car(number);
    let at = |error| TrialError::File(programs.folder.to_owned(), error);
    let mut of_all: Vec<String> = Vec::new();
    for (k, km_per_h) in tests.iter().enumerate() {
        fs::create_dir_all(programs.folder.join(k.to_string())).map_err(at)?;
        let [crash, raw, filtered, integrated] =
            ["crash.csv", "1.mcap", "2.mcap", "3.mcap"].map(|f| format!("{k}/{f}"));
        fs::write(programs.folder.join(&crash), record(&car, km_per_h / 3.6, k)).map_err(at)?;
        programs.step("ingest", &[&crash, "--time-zero", "0s", "-o", &raw])?;
        programs.step("filter", &[&raw, "-o", &filtered])?;
        programs.step("integrate", &[&filtered, "-o", &integrated])?;
        of_all.extend([filtered, integrated].map(|path| format!("{k}:{path}")));
    }
    let (mut arguments, inputs) = if let [_] = tests {
        programs.step("identify", &["0/2.mcap", "0/3.mcap", "-o", "4.mcap"])?;
        (vec!["0/2.mcap", "0/3.mcap", "4.mcap"], &["0/3.mcap", "5.mcap"][..])
    } else {
        (of_all.iter().map(String::as_str).collect(), &["5.mcap"][..])
    };
    arguments.extend(["--json", "-o", "5.mcap"]);
    let solved = programs.step("parameter-solve", &arguments)?;
    // The first candidate of each model and method.
    let mut first: BTreeMap<String, String> = BTreeMap::new();
    for (id, _) in records(&solved, "/parameters/") {
        let method = id.rsplit_once('/').map_or(id.as_str(), |(method, _)| method).to_owned();
        first.entry(method).or_insert(id);
    }
    let truths: Vec<Truth> = ASKED.iter().map(|(speed, factor)| car.truth(speed / 3.6, *factor)).collect();
    let mass_kg = car.mass_kg();
    let mut answers: Vec<Value> = programs.predictions(inputs, None, mass_kg)?;
    answers.retain(|answer| answer["recommended"] == true);
    let recommended = answers.first().and_then(|answer| answer["candidate"].as_str());
    let mut outcome = Outcome {
        kind: kind.name,
        number,
        recommended: recommended.map(|id| id.rsplit_once('/').map_or(id, |(method, _)| method).to_owned()),
        predictions: vec![(Answer::Recommended, scored(&answers, mass_kg, &truths))],
    };
    for (method, id) in first {
        let answers = programs.predictions(inputs, Some(&id), mass_kg)?;
        outcome.predictions.push((Answer::Candidate(method), scored(&answers, mass_kg, &truths)));
    }
    Ok(outcome)
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

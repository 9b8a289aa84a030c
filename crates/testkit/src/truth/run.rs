//! A run of a case by the programs, and what it says where.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;
use std::process::{Command, Output};

use crumple_artifact::records::{RatedCandidateV1, RecommendationV1};
use crumple_artifact::{Artifact, Wave};
use crumple_signal::Sampled;
use serde_json::Value;

use super::cases::{Question, RunCase};
use super::known::{Known, Subject};
use super::page::{Block, captions, first_screen};
use super::shown::plain;
use crate::programs::pipeline::{ARTIFACTS, just};

/// What a run has left.
#[derive(Debug)]
pub struct Made {
    /// The case's name.
    pub name: String,
    /// What is true of its record.
    pub known: Known,
    /// What was asked of it.
    pub question: Option<Question>,
    /// Exit code.
    pub code: i32,
    /// What it printed, line by line.
    pub console: Vec<String>,
    /// `summary.json`.
    pub summary: Value,
    /// The texts of the first screen of `report.html`.
    pub page: Vec<Block>,
    /// The captions of all figures of `report.html`, as one text.
    pub captions: String,
    /// Waves by topic without its beginning, those of later stages in the place of earlier ones.
    pub waves: BTreeMap<String, Wave>,
    /// The records of its artifacts: topic and content.
    pub records: Vec<(String, Value)>,
    /// The choice of a candidate.
    pub choice: Option<RecommendationV1>,
    /// Every number of the summary and of those records, also of their texts; of waves the ends and the counts.
    pub all_numbers: Vec<f64>,
}

/// Why a run could not be read.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Runs a case in a folder of its own by the programs in `bin`. Errors: the run ends with another code than 0 or 4, or
/// leaves no summary or page.
pub fn run(case: &RunCase, bin: &Path, folder: &Path) -> Result<Made, Failure> {
    let folder = folder.join(case.name.replace(|c: char| !c.is_ascii_alphanumeric(), "-"));
    let variables = || {
        let own = case.variables.iter().map(|variable| variable.replace("$BIN", &bin.display().to_string()));
        std::iter::once(format!("bin={}", bin.display())).chain(own)
    };
    let mut output = if case.known.subject == Subject::InputOutput {
        identify_alone(case, bin, &folder)?
    } else {
        let mut command = just();
        command.args(variables()).arg(format!("out={}", folder.display()));
        command.arg("run").arg(&case.record).args(&case.flags).env("RAYON_NUM_THREADS", "1").output()?
    };
    if let Some(question) = case.question.filter(|_| output.status.success()) {
        let mut command = just();
        command.args(variables()).arg("predict").arg(&folder).args(question.flags);
        output = command.env("RAYON_NUM_THREADS", "1").output()?;
    }
    if !case.reported.is_empty() && output.status.success() {
        output = report_alone(case, bin, &folder)?;
    }
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let code = output.status.code().unwrap_or(-1);
    if !matches!(code, 0 | 4) {
        return Err(format!("{}: exit {code}: {said}", case.name).into());
    }
    let made = Made::read(case, code, &said, &folder)?;
    fs::remove_dir_all(&folder)?;
    Ok(made)
}

/// Only some artifacts are left and reported anew; what the report prints.
fn report_alone(case: &RunCase, bin: &Path, folder: &Path) -> Result<Output, Failure> {
    for (_, name) in ARTIFACTS.iter().enumerate().filter(|(place, _)| !case.reported.contains(place)) {
        match fs::remove_file(folder.join(name)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error.into()),
            _ => {}
        }
    }
    let left = case.reported.iter().map(|place| ARTIFACTS[*place]);
    let arguments = left.chain(["-o", "report.html", "--summary", "summary.json"]);
    Ok(Command::new(bin.join("crumple-report")).args(arguments).current_dir(folder).output()?)
}

/// A record that is no crash goes through ingest, identify and report, by their own commands; what the report prints.
fn identify_alone(case: &RunCase, bin: &Path, folder: &Path) -> Result<Output, Failure> {
    fs::create_dir_all(folder)?;
    let record = case.record.display().to_string();
    let (ingest, identify): (Vec<&str>, Vec<&str>) =
        case.flags.iter().map(String::as_str).partition(|flag| INGEST.iter().any(|own| flag.starts_with(own)));
    let steps: [(&str, Vec<&str>); 3] = [
        ("ingest", [vec![record.as_str(), "-q", "-o", ARTIFACTS[0]], ingest].concat()),
        ("identify", [vec![ARTIFACTS[0], "-q", "-o", ARTIFACTS[3]], identify].concat()),
        ("report", vec![ARTIFACTS[0], ARTIFACTS[3], "-o", "report.html", "--summary", "summary.json"]),
    ];
    let mut last = Err("no step".into());
    for (program, arguments) in steps {
        let output =
            Command::new(bin.join(format!("crumple-{program}"))).args(arguments).current_dir(folder).output()?;
        if !matches!(output.status.code(), Some(0 | 4)) {
            return Ok(output);
        }
        last = Ok(output);
    }
    last
}

/// Flags of ingest among those of such a record; the others are those of identify.
const INGEST: [&str; 2] = ["--sample-time", "--allow-missing"];

impl Made {
    fn read(case: &RunCase, code: i32, said: &str, folder: &Path) -> Result<Self, Failure> {
        let (mut waves, mut records, mut all_numbers) = (BTreeMap::new(), Vec::new(), Vec::new());
        for path in ARTIFACTS.iter().map(|name| folder.join(name)).filter(|path| path.is_file()) {
            let artifact = Artifact::open(&path)?;
            artifact.waves().values().for_each(|wave| numbers_of_wave(&wave.sampled, &mut all_numbers));
            waves.extend(artifact.waves().iter().map(|(id, wave)| (id.clone(), wave.clone())));
            let json = artifact.records().iter().filter(|raw| raw.encoding == "json");
            for raw in json {
                records.push((raw.topic.clone(), serde_json::from_slice(&raw.payload)?));
            }
        }
        let read = |name: &str| -> io::Result<String> { fs::read_to_string(folder.join(name)) };
        let summary: Value = serde_json::from_str(&read("summary.json")?)?;
        records.iter().map(|(_, record)| record).chain([&summary]).for_each(|value| collect(value, &mut all_numbers));
        let html = read("report.html")?;
        let choice = records.iter().find(|(topic, _)| topic == "/recommendation");
        Ok(Self {
            all_numbers,
            choice: choice.map(|(_, record)| serde_json::from_value(record.clone())).transpose()?,
            name: case.name.clone(),
            known: case.known.clone(),
            question: case.question,
            code,
            console: said.lines().map(plain_line).collect(),
            summary,
            page: first_screen(&html),
            captions: captions(&html),
            waves,
            records,
        })
    }

    /// A number of the summary.
    pub fn number(&self, pointer: &str) -> Option<f64> {
        self.summary.pointer(pointer)?.as_f64()
    }

    /// A text of the summary.
    pub fn text(&self, pointer: &str) -> &str {
        self.summary.pointer(pointer).and_then(Value::as_str).unwrap_or_default()
    }

    /// A list of the summary.
    pub fn list(&self, pointer: &str) -> &[Value] {
        self.summary.pointer(pointer).and_then(Value::as_array).map_or(&[], Vec::as_slice)
    }

    /// A candidate by its id.
    pub fn candidate(&self, id: &str) -> Option<&Value> {
        self.list("/candidates").iter().find(|candidate| candidate["id"] == id)
    }

    /// The recommended one.
    pub fn recommended(&self) -> Option<&Value> {
        self.candidate(self.summary["recommended"].as_str()?)
    }

    /// A candidate by its name in words: `Kelvin, direct fit 1`.
    pub fn candidate_named(&self, words: &str) -> Option<&Value> {
        self.list("/candidates")
            .iter()
            .find(|candidate| candidate["id"].as_str().map(in_words) == Some(words.to_owned()))
    }

    /// How the choice rated a candidate.
    pub fn rated(&self, candidate: &Value) -> Option<&RatedCandidateV1> {
        self.choice.as_ref()?.candidates.iter().find(|rated| candidate["id"] == rated.id.as_str())
    }

    /// What the warnings say, gravest first.
    pub fn concerns(&self) -> impl Iterator<Item = &str> {
        self.list("/concerns").iter().filter_map(|concern| concern["text"].as_str())
    }

    /// Whether it is of a vehicle at a wall.
    pub fn is_of_a_vehicle(&self) -> bool {
        self.known.subject == Subject::Vehicle
    }
}

/// What is said of a wave: its mean, also over its deviation, its ends, its extremes, its first instant, and how many
/// samples it has in all, before and
/// from time zero on.
fn numbers_of_wave(wave: &Sampled, numbers: &mut Vec<f64>) {
    let samples = wave.samples();
    let (low, high) =
        samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    let before = (-wave.t0_s() / wave.dt_s()).round();
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    let deviation = (samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / samples.len() as f64).sqrt();
    numbers.extend([mean, mean / deviation]);
    let counts = [samples.len() as f64, before, samples.len() as f64 - before];
    numbers.extend(counts.into_iter().flat_map(|count| [count, count - 1.0, count - 2.0]));
    numbers.extend(samples.first().into_iter().chain(samples.last()).chain([&low, &high, &wave.t0_s()]));
}

/// Settings stand in records as texts, as a person types them; sentences are none of a record's numbers.
const LONGEST_SETTING: usize = 40;

fn collect(value: &Value, numbers: &mut Vec<f64>) {
    match value {
        Value::Number(number) => numbers.extend(number.as_f64()),
        Value::Array(values) => values.iter().for_each(|value| collect(value, numbers)),
        Value::Object(fields) => fields.values().for_each(|value| collect(value, numbers)),
        Value::String(text) if text.len() < LONGEST_SETTING => {
            numbers.extend(super::shown::numbers(text).iter().map(|shown| shown.value));
        }
        _ => {}
    }
}

/// A candidate's id as people read it: `kelvin/direct-fit/1` is "Kelvin, direct fit 1".
pub fn in_words(id: &str) -> String {
    let mut parts = id.splitn(3, '/');
    let (model, method, index) = (parts.next().unwrap_or_default(), parts.next(), parts.next());
    let model = model.replace("spring-mass-damper", "spring_mass_damper").replace('-', " ").replace('_', "-");
    let mut letters = model.chars();
    let model: String = letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect();
    match (method, index) {
        (Some(method), Some(index)) => format!("{model}, {} {index}", method.replace('-', " ")),
        _ => id.to_owned(),
    }
}

/// A line with its blanks at the start, which say whose it is.
fn plain_line(line: &str) -> String {
    let start = line.len() - line.trim_start().len();
    format!("{}{}", &line[..start], if start < line.len() { spaced(&line[start..]) } else { String::new() })
}

/// Columns of blanks stay; characters that look like blanks become one.
fn spaced(text: &str) -> String {
    let (label, rest) = text.split_once("  ").unwrap_or(("", text));
    if label.is_empty() { plain(rest) } else { format!("{}  {}", plain(label), plain(rest)) }
}

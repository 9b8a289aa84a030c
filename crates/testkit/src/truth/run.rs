//! The runs of the cases by the programs, and what each has left.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Output};
use std::{fs, io};

use crumple_artifact::Artifact;
use crumple_signal::Sampled;
use rayon::prelude::*;
use serde_json::Value;

use crate::places::workspace;
use crate::programs::ARTIFACTS;
use crate::truth::cases::{Question, RunCase};
use crate::truth::known::{Impact, Known, Subject};
use crate::truth::page_text::first_screen;

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
    /// `summary.json`.
    pub summary: Value,
    /// What it says where: name of the surface, text.
    pub surfaces: Vec<(&'static str, String)>,
    /// The channels as they were read, in the order of the file.
    pub raw: BTreeMap<String, Sampled>,
    /// Waves by topic without its beginning, those of later stages in the place of earlier ones.
    pub waves: BTreeMap<String, Sampled>,
    /// The records of its artifacts by topic.
    pub records: BTreeMap<String, Value>,
}

/// Why a run could not be read.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Runs cases by the programs in `bin`, in folders of their own below `folder`; in the order of the cases. Cases of one
/// record, pipeline and flags share its chain. Errors: a run ends with another code than 0 or 4, or leaves no summary
/// or page.
pub fn run_all(cases: &[&RunCase], bin: &Path, folder: &Path) -> Vec<Result<Made, Failure>> {
    let mut chains: BTreeMap<_, Vec<(usize, &RunCase)>> = BTreeMap::new();
    for (place, case) in cases.iter().enumerate() {
        let chain = (&case.record, &case.pipeline, &case.stage, &case.flags);
        chains.entry(chain).or_default().push((place, case));
    }
    let programs = Programs { bin, folder };
    let of_chain = |(number, cases): (usize, Vec<(usize, &RunCase)>)| programs.chain(number, &cases);
    let chains: Vec<_> = chains.into_values().enumerate().collect();
    let mut all: Vec<_> = chains.into_par_iter().flat_map_iter(of_chain).collect();
    all.sort_by_key(|(place, _)| *place);
    all.into_iter().map(|(_, made)| made).collect()
}

/// Flags of ingest among those of inputs and outputs; the others are those of identify.
const INGEST: [&str; 2] = ["--sample-time", "--allow-missing"];

/// The Markdown of a report, in the folder of its run.
const MARKDOWN: &str = "report.md";

#[derive(Debug, Clone, Copy)]
struct Programs<'a> {
    bin: &'a Path,
    folder: &'a Path,
}

impl Programs<'_> {
    /// The chain once, then what each of its cases asks of it, in one folder.
    fn chain(&self, number: usize, cases: &[(usize, &RunCase)]) -> Vec<(usize, Result<Made, Failure>)> {
        let folder = self.folder.join(number.to_string());
        let chain = cases.first().map(|(_, first)| match first.known.subject {
            Subject::InputOutput => self.identify_alone(first, &folder),
            _ => self.run(first, "--out", &folder, first.record.to_str(), &first.flags),
        });
        let made = |case: &RunCase| match &chain {
            Some(Ok(output)) => self.made(case, output, &folder),
            Some(Err(error)) => Err(error.to_string().into()),
            None => Err("no case".into()),
        };
        let all = cases.iter().map(|(place, case)| (*place, made(case))).collect();
        // What is left is removed with the folder of all.
        let _left = fs::remove_dir_all(&folder);
        all
    }

    /// What a case asks of a chain: other impacts, a report of some artifacts, or nothing more.
    fn made(&self, case: &RunCase, chain: &Output, folder: &Path) -> Result<Made, Failure> {
        let more = match case.question.filter(|_| chain.status.success()) {
            Some(Question { flags, .. }) => Some(self.run(case, "--again", folder, Some("--"), flags)?),
            None if case.reported.is_empty() => None,
            None => Some(self.report(case.reported.iter().map(|place| ARTIFACTS[*place]), folder)?),
        };
        // They are those of all artifacts.
        let notes = self.command(&["notes"]).arg(folder).output()?.stdout;
        let notes = if case.reported.is_empty() { String::from_utf8_lossy(&notes).into_owned() } else { String::new() };
        Made::read(case, more.as_ref().unwrap_or(chain), folder, notes)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(self.bin.join("crumple"));
        command.args(arguments).env("RAYON_NUM_THREADS", "1");
        command
    }

    fn run<S: AsRef<OsStr>>(
        &self,
        case: &RunCase,
        into: &str,
        folder: &Path,
        first: Option<&str>,
        flags: &[S],
    ) -> io::Result<Output> {
        let markdown = format!("--markdown {}", folder.join(MARKDOWN).display());
        let mut command = self.command(&["run", "--pipeline", &case.pipeline, "--flags-of-last", &markdown, into]);
        command.arg(folder).arg("--project").arg(workspace());
        if let Some(stage) = &case.stage {
            command.arg("--stage").arg(stage.replace("$BIN", &self.bin.display().to_string()));
        }
        command.args(first).args(flags).output()
    }

    fn report<'b>(&self, artifacts: impl Iterator<Item = &'b str>, folder: &Path) -> io::Result<Output> {
        let outputs = ["-o", "report.html", "--summary", "summary.json", "--markdown", MARKDOWN];
        self.command(&["report"]).args(artifacts).args(outputs).current_dir(folder).output()
    }

    /// A record that is no crash goes through ingest, identify and report, by their own commands; what the report
    /// prints.
    fn identify_alone(&self, case: &RunCase, folder: &Path) -> io::Result<Output> {
        fs::create_dir_all(folder)?;
        let record = case.record.display().to_string();
        let (ingest, identify): (Vec<&str>, Vec<&str>) =
            case.flags.iter().map(String::as_str).partition(|flag| INGEST.iter().any(|own| flag.starts_with(own)));
        let steps = [
            [&["ingest", &record, "-q", "-o", ARTIFACTS[0]], ingest.as_slice()].concat(),
            [&["identify", ARTIFACTS[0], "-q", "-o", ARTIFACTS[3]], identify.as_slice()].concat(),
        ];
        for arguments in steps {
            let output = self.command(&arguments).current_dir(folder).output()?;
            if !matches!(output.status.code(), Some(0 | 4)) {
                return Ok(output);
            }
        }
        self.report([ARTIFACTS[0], ARTIFACTS[3]].into_iter(), folder)
    }
}

impl Made {
    fn read(case: &RunCase, output: &Output, folder: &Path, notes: String) -> Result<Self, Failure> {
        let said = [&output.stdout, &output.stderr].map(|stream| String::from_utf8_lossy(stream).into_owned()).concat();
        let code = output.status.code().unwrap_or(-1);
        if !matches!(code, 0 | 4) {
            return Err(format!("{}: exit {code}: {said}", case.name).into());
        }
        let (mut waves, mut raw, mut records) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
        let is_asked = |place: &usize| case.reported.is_empty() || case.reported.contains(place);
        let paths = (0..ARTIFACTS.len()).filter(is_asked).map(|place| folder.join(ARTIFACTS[place]));
        for path in paths.filter(|path| path.is_file()) {
            let artifact = Artifact::open(&path)?;
            waves.extend(artifact.waves().iter().map(|(id, wave)| (id.clone(), wave.sampled.clone())));
            if path.ends_with(ARTIFACTS[0]) {
                raw.clone_from(&waves);
            }
            for record in artifact.records().iter().filter(|raw| raw.encoding == "json") {
                records.insert(record.topic.clone(), serde_json::from_slice::<Value>(&record.payload)?);
            }
        }
        let read = |name: &str| -> io::Result<String> { fs::read_to_string(folder.join(name)) };
        let markdown = read(MARKDOWN)?;
        // The command that makes the run again is as it was typed.
        let markdown = markdown.split_once("### Again").map_or(markdown.as_str(), |(before, _)| before);
        let surfaces = vec![
            ("console", said.replace(&folder.display().to_string(), "RUN")),
            ("first screen", first_screen(&read("report.html")?)),
            ("Markdown", markdown.to_owned()),
            ("notes", notes),
        ];
        let (name, known, question) = (case.name.clone(), case.known.clone(), case.question);
        let summary = serde_json::from_str(&read("summary.json")?)?;
        Ok(Self { name, known, question, code, summary, surfaces, raw, waves, records })
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

    /// How the choice rated a candidate.
    pub fn rated(&self, candidate: &Value) -> Option<&Value> {
        let rated = self.records.get("/recommendation")?["candidates"].as_array()?;
        rated.iter().find(|rated| rated["id"] == candidate["id"])
    }

    /// An identified model by its id.
    pub fn model(&self, id: &str) -> Option<&Value> {
        self.list("/models").iter().find(|model| model["id"] == id)
    }

    /// A key number by its name.
    pub fn key_number(&self, name: &str) -> Option<&Value> {
        self.list("/key_numbers").iter().find(|number| number["name"] == name)
    }

    /// Whether it is of a vehicle at a wall.
    pub fn is_of_a_vehicle(&self) -> bool {
        self.known.subject == Subject::Vehicle
    }

    /// The truth of the test that was made, of a sound record of a vehicle.
    pub fn own_test(&self) -> Option<Impact> {
        self.true_test().filter(|_| self.known.is_sound)
    }

    /// The same of a vehicle whatever its record states.
    pub fn true_test(&self) -> Option<Impact> {
        self.known.impact(self.known.speed_m_per_s?, self.known.mass_kg?).filter(|_| self.is_of_a_vehicle())
    }

    /// Whether a record is a sound one of a vehicle as cars are: it rebounds at a third of its speed at most. A spring
    /// that stays attached, and so pulls its mass back, may be asked about.
    pub fn is_like_a_car(&self) -> bool {
        self.own_test().is_some_and(|truth| truth.restitution <= 0.3)
    }

    /// The velocity of the pulse.
    pub fn velocity(&self) -> Option<&Sampled> {
        self.waves.get(&format!("{}/velocity", self.text("/test/channel")))
    }

    /// The pulse as it was read.
    pub fn pulse(&self) -> Option<&Sampled> {
        self.raw.get(self.text("/test/channel"))
    }

    /// Length of the record, s; 1 without a pulse.
    pub fn length_s(&self) -> f64 {
        self.pulse().map_or(1.0, |pulse| pulse.len() as f64 * pulse.dt_s())
    }

    /// Mean and standard deviation of the pulse as it was read between two times, s; up to the end without the second.
    pub fn level(&self, from_s: f64, to_s: Option<f64>) -> Option<(f64, f64)> {
        let pulse = self.pulse()?;
        let place = |time_s: f64| (((time_s - pulse.t0_s()) / pulse.dt_s()).round().max(0.0)) as usize;
        let samples = pulse.samples();
        let end = to_s.map_or(samples.len(), place).min(samples.len());
        let samples = samples.get(place(from_s)..end).filter(|samples| !samples.is_empty())?;
        let mean = samples.iter().sum::<f64>() / samples.len() as f64;
        let variance = samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / samples.len() as f64;
        Some((mean, variance.sqrt()))
    }
}

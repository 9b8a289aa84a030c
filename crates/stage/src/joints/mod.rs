//! What two statements of a run contradict each other in: one row an invariant, checked by whoever reads.
//!
//! A row tests physics from the curves and the figures beside them, whatever program wrote them. Where a figure and its
//! curve differ, one of both is wrong, and nothing that is made from them can be right.

pub mod candidates;
pub mod curves;
pub mod filtering;
pub mod models;
pub mod motion;
pub mod predictions;

use std::cell::OnceCell;
use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use crumple_artifact::records::{CandidateV1, RemarkV1, TestV1, ValueV1};
use crumple_artifact::{Artifact, Record};
use crumple_signal::{About, Kind, Sampled};

use crate::command_line::pipeline_file::Pipeline;
use crate::error::Refused;
use crate::names::{chain, stage_order};

/// A row: what must hold, and what it means where it does not.
pub struct Invariant {
    /// Its code and its explanation; the weight is that of a warning.
    pub kind: Kind,
    /// Whether nothing can be made from what contradicts itself; else it is a warning.
    pub ends_the_run: bool,
    /// Looks at one run.
    find: fn(&RunParts<'_>) -> Vec<Finding>,
}

/// What a row found.
pub(crate) struct Finding {
    /// The stage that wrote what contradicts.
    stage: &'static str,
    about: About,
    /// The numbers of the sentence, names with units.
    values: Vec<(&'static str, f64)>,
    /// One sentence, made from the values.
    text: String,
}

/// A contradiction in a run, as every surface shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Contradiction {
    /// Code and explanation of its row.
    pub kind: &'static Kind,
    /// Whether nothing can be made from it.
    pub ends_the_run: bool,
    /// The stage that wrote what contradicts.
    pub stage: &'static str,
    /// What it concerns.
    pub about: About,
    /// The numbers of the sentence, names with units.
    pub values: Vec<(&'static str, f64)>,
    /// One sentence.
    pub text: String,
}

/// The rows of one joint.
struct Joint {
    rows: &'static [Invariant],
    /// Stages whose artifacts the rows look at, where they are there.
    looks_at: &'static [&'static str],
    /// Table of the pipeline that the rows ask for what was wanted.
    asks: Option<&'static str>,
}

/// Every joint, in the order of the chain.
static JOINTS: [Joint; 5] = [
    Joint { rows: &filtering::ROWS, looks_at: &["ingest", "filter"], asks: None },
    Joint { rows: &motion::ROWS, looks_at: &["ingest", "filter", "integrate"], asks: None },
    Joint { rows: &models::ROWS, looks_at: &["identify"], asks: None },
    Joint { rows: &candidates::ROWS, looks_at: &["integrate", "parameter-solve", "simulate", "predict"], asks: None },
    Joint { rows: &predictions::ROWS, looks_at: &["integrate", "parameter-solve", "predict"], asks: Some("predict") },
];

/// Every row, in the order of the chain.
pub fn invariants() -> impl Iterator<Item = &'static Invariant> {
    JOINTS.iter().flat_map(|joint| joint.rows)
}

/// Every contradiction of the artifacts of one run: those that end it first, then the gravest, each in the order of the
/// chain. `pipeline` says what was asked for, where it is known.
pub fn contradictions(artifacts: &[Artifact], pipeline: Option<&Pipeline>) -> Vec<Contradiction> {
    let artifacts = artifacts.iter().filter_map(|a| Some((stage_of(a)?, a))).collect();
    let parts = RunParts { artifacts, pipeline, candidates: OnceCell::new() };
    let mut found: Vec<Contradiction> = JOINTS.iter().flat_map(|joint| joint.contradictions(&parts)).collect();
    found.sort_by_key(|c| (!c.ends_the_run, Reverse(c.kind.weight), stage_order(Some(c.stage))));
    found
}

/// What this process has found no contradiction in: every stage of a run reads what those before it have read.
static SOUND: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

impl Joint {
    fn contradictions(&self, parts: &RunParts<'_>) -> Vec<Contradiction> {
        let seen = self.seen(parts);
        let is_sound = || SOUND.lock().unwrap_or_else(PoisonError::into_inner).contains(&seen);
        if is_sound() {
            return Vec::new();
        }
        let of_row = |row: &'static Invariant| {
            (row.find)(parts).into_iter().map(|finding| Contradiction {
                kind: &row.kind,
                ends_the_run: row.ends_the_run,
                stage: finding.stage,
                about: finding.about,
                values: finding.values,
                text: finding.text,
            })
        };
        let found: Vec<Contradiction> = self.rows.iter().flat_map(of_row).collect();
        if found.is_empty() {
            SOUND.lock().unwrap_or_else(PoisonError::into_inner).insert(seen);
        }
        found
    }

    /// All that the rows look at, by its digests, and what was asked for.
    fn seen(&self, parts: &RunParts<'_>) -> String {
        let looked_at = parts.artifacts.iter().filter(|(stage, _)| self.looks_at.contains(stage));
        let digests = looked_at.map(|(stage, artifact)| format!("{stage} {} ", artifact.digest()));
        let asked = self.asks.and_then(|table| parts.pipeline?.table(table));
        format!("{}{}{asked:?}", self.rows[0].kind.code, digests.collect::<String>())
    }
}

/// Errors: the artifacts contradict each other, or themselves, in what nothing can be made from.
pub(crate) fn refuse_contradictions(artifacts: &[Artifact]) -> Result<(), Refused> {
    let found = contradictions(artifacts, None);
    let Some(first) = found.iter().find(|found| found.ends_the_run) else { return Ok(()) };
    let others = found.iter().filter(|other| other.stage == first.stage && *other != first);
    let others: String = others.map(|other| format!("; {} [{}]", other.text, other.kind.code)).collect();
    let text = format!("{}: {} [{}]{others}", first.file(artifacts), first.text, first.kind.code);
    Err(Refused::new(text).hint(first.kind.explanation[3]))
}

impl Contradiction {
    /// As it is printed: an error, or a warning, with what to do.
    pub fn in_lines(&self, artifacts: &[Artifact]) -> String {
        let how = if self.ends_the_run { "error" } else { "warning" };
        format!(
            "{how}: {}: {} [{}]\n  hint: {}",
            self.file(artifacts),
            self.text,
            self.kind.code,
            self.kind.explanation[3]
        )
    }

    /// As a warning of a run, which a program reads by its code. A program from elsewhere that wrote it is named.
    pub fn remark(&self, program: Option<&str>) -> RemarkV1 {
        RemarkV1 {
            code: self.kind.code.to_owned(),
            stage: self.stage.to_owned(),
            about: self.about.to_string(),
            weight: self.kind.weight.number(),
            values: self.values.iter().map(|(name, value)| ((*name).to_owned(), ValueV1::Number(*value))).collect(),
            text: self.text.clone(),
            remedy: Some(self.kind.explanation[3].to_owned()),
            written_by: program.map(str::to_owned),
        }
    }

    /// The file that says it.
    fn file(&self, artifacts: &[Artifact]) -> String {
        let written = artifacts.iter().find(|artifact| stage_of(artifact) == Some(self.stage));
        written.map_or_else(|| self.stage.to_owned(), |artifact| artifact.path().display().to_string())
    }
}

/// The stage that an artifact stands for: by its name in a run folder, else by what it states.
fn stage_of(artifact: &Artifact) -> Option<&'static str> {
    let name = artifact.path().file_name().unwrap_or_default().to_string_lossy();
    let named = chain().find(|stage| stage.outputs.first() == Some(&&*name));
    named.or_else(|| chain().find(|stage| Some(stage.name) == artifact.stage())).map(|stage| stage.name)
}

/// The artifacts of one run by the stages that they stand for.
pub(crate) struct RunParts<'a> {
    artifacts: Vec<(&'static str, &'a Artifact)>,
    /// What was asked for, where it is known.
    pipeline: Option<&'a Pipeline>,
    /// Those of parameter-solve with their ids, decoded once.
    candidates: OnceCell<Vec<(&'a str, CandidateV1)>>,
}

impl<'a> RunParts<'a> {
    /// The candidates of parameter-solve, by their ids.
    fn candidates(&self) -> &[(&'a str, CandidateV1)] {
        let read = || self.of("parameter-solve").map_or_else(Vec::new, |of| records(of, "/parameters/").collect());
        self.candidates.get_or_init(read)
    }

    /// That of a stage.
    fn of(&self, stage: &str) -> Option<&'a Artifact> {
        self.artifacts.iter().find(|(name, _)| *name == stage).map(|(_, artifact)| *artifact)
    }

    /// All but that of ingest, which is made from no other, with their stages.
    fn made(&self) -> impl Iterator<Item = (&'static str, &'a Artifact)> {
        self.artifacts.iter().filter(|(stage, _)| *stage != "ingest").copied()
    }

    /// The latest that has a channel among those up to a stage, as a curve.
    fn wave(&self, id: &str, last: &str) -> Option<&'a Sampled> {
        let before = self.artifacts.iter().filter(|(stage, _)| stage_order(Some(stage)) <= stage_order(Some(last)));
        let (_, wave) = before
            .filter_map(|(stage, artifact)| Some((stage_order(Some(stage)), artifact.waves().get(id)?)))
            .max_by_key(|(order, _)| *order)?;
        Some(&wave.sampled).filter(|wave| wave.len() > 1)
    }
}

/// The record of a type under a topic, where it is there and can be read: who needs it says why it cannot.
fn record<R: Record>(artifact: &Artifact, topic: &str) -> Option<R> {
    artifact.record(topic).ok().flatten()
}

/// The records of a type below a topic, with the rest of their topics.
fn records<'a, R: Record>(artifact: &'a Artifact, prefix: &'a str) -> impl Iterator<Item = (&'a str, R)> {
    artifact.records().iter().filter(|raw| raw.schema == R::SCHEMA).filter_map(move |raw| {
        let rest = raw.topic.strip_prefix(prefix)?;
        Some((rest, artifact.decode(raw).ok()?))
    })
}

/// The crash pulse of a test: the channel named, else the only acceleration.
fn pulse_of(test: &TestV1) -> Option<&str> {
    let mut accelerations = test.channels.iter().filter(|channel| channel.quantity == "acceleration");
    let only = accelerations.next().filter(|_| accelerations.next().is_none());
    test.pulse.as_deref().or_else(|| only.map(|channel| channel.id.as_str()))
}

/// Whether a value lies outside of an interval by more than half its width: that of a closed form, or of a metric that
/// is zero, may lie beside what repetitions say of it.
fn is_outside(value: f64, low: f64, high: f64) -> bool {
    let beside = (low - value).max(value - high);
    beside > 0.5 * (high - low) + 1e-9 * value.abs().max(low.abs()).max(high.abs())
}

/// What the explanation of a row of intervals says of it.
const BESIDE: &str = "Each interval is compared with its value; half its width is left, since a closed form may lie \
                      beside what repetitions say.";

//! What `diff` and `accept` read: one side of a comparison, and which result is compared with which.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use crumple_artifact::records::TestV1;
use crumple_artifact::{Artifact, WAVE_PREFIX};
use crumple_diff::{
    CompareSettings, DiffError, FileReport, Side as OnlyIn, compare_artifacts, compare_json, open_candidates,
};
use crumple_stage::{Pipeline, chain, refuse_a_mixture, sidecar_of};
use serde_json::{Value, json};

use super::gather::stage_record;
use super::run_folders::{FoundRun, SUMMARY, is_json, name_of, read_json, results_in, runs_below};
use crate::Summary;
use crate::compare::causes::{LIMITS, line_of};
use crate::compare::expected::{Expected, Limits};

/// One side of a comparison.
pub struct Side {
    /// What a review compares.
    pub kept: Expected,
    /// The topics of its artifacts.
    pub topics: BTreeSet<String>,
    /// Whether it is nothing but what was accepted.
    pub is_kept: bool,
    artifacts: Vec<Artifact>,
}

impl Side {
    /// An artifact, a run folder, a summary, or what was accepted.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let mut topics = BTreeSet::from([SUMMARY.to_owned()]);
        if is_json(path) {
            let value = read_json(path)?;
            if Expected::is_schema(&value["schema"]) {
                let damaged = |source| DiffError::Json { path: path.to_owned(), source };
                let kept = serde_json::from_value(value).map_err(damaged)?;
                return Ok(Self { kept, topics, is_kept: true, artifacts: Vec::new() });
            }
            // Another summary than of this version has no numbers to show, and is compared value by value.
            let summary: Summary = serde_json::from_value(value).unwrap_or_default();
            let kept = Expected { summary, is_summary_alone: true, ..Expected::default() };
            return Ok(Self { kept, topics, is_kept: false, artifacts: Vec::new() });
        }
        let paths: Vec<PathBuf> = match path.is_dir() {
            true => results_in(path)?.into_iter().filter(|name| name != SUMMARY).map(|name| path.join(name)).collect(),
            false => vec![path.to_owned()],
        };
        let mut kept = Expected::default();
        let mut artifacts = Vec::new();
        for path in &paths {
            let artifact = Artifact::open(path).map_err(DiffError::from)?;
            kept.stages.push(stage_record(&artifact));
            topics.extend(artifact.records().iter().map(|raw| raw.topic.clone()));
            topics.extend(artifact.waves().keys().map(|id| format!("{WAVE_PREFIX}{id}")));
            if let Some(test) = artifact.record::<TestV1>("/test").map_err(DiffError::from)? {
                kept.record = [test.source.name, test.source.digest];
                kept.contact = test.contact;
            }
            if chain().any(|stage| stage.outputs.iter().any(|name| path.ends_with(name))) {
                artifacts.push(artifact);
            }
        }
        let own = path.join(Pipeline::OF_A_RUN);
        if own.is_file() {
            let own = Pipeline::read(&own, None)?;
            kept.stages.iter_mut().for_each(|record| record.name_program(&own));
            kept.options = options_of(&own);
            kept.limits = limits_of(&own);
        }
        let of_run = path.join(SUMMARY);
        if of_run.is_file() {
            kept.summary = serde_json::from_value(read_json(&of_run)?).unwrap_or_default();
        }
        Ok(Self { kept, topics, is_kept: false, artifacts })
    }

    /// Errors: its artifacts, those named as a run names them, are of two runs.
    pub fn refuse_a_mixture(&self) -> anyhow::Result<()> {
        refuse_a_mixture(&self.artifacts, |artifact| artifact.path().display().to_string())
    }
}

/// The limits within which a pipeline says that its runs are the same.
pub fn limits_of(pipeline: &Pipeline) -> Limits {
    pipeline.limits().into_iter().flatten().map(|(pattern, limit)| (pattern.clone(), json!(limit))).collect()
}

/// The options of a run by stage, with what was typed for each.
fn options_of(pipeline: &Pipeline) -> BTreeMap<String, Value> {
    let of_stage = |stage: &str| {
        let mut options = json!(pipeline.table(stage)?);
        if let Some(typed) = pipeline.typed("flags", stage) {
            options["flags"] = json!(typed);
        }
        Some((stage.to_owned(), options))
    };
    // The report says what is there, and changes none of it.
    chain().filter(|stage| stage.name != "report").filter_map(|stage| of_stage(stage.name)).collect()
}

/// File and line that state what a run was made with: the project's pipeline of the run's name where this says what the
/// run's own says, else the run's own; of the test a flag, the file beside the record, or a line in front of it.
pub fn place_of(folder: &Path, stage: &str, key: &str) -> Option<(String, usize)> {
    let own = folder.join(Pipeline::OF_A_RUN);
    let pipeline = Pipeline::read(&own, None).ok()?;
    let text = fs::read_to_string(&own).ok()?;
    let in_file = |path: &Path, line: usize| (path.display().to_string(), line);
    if stage == "test" {
        return place_of_test(&pipeline, key).or_else(|| Some(in_file(&own, line_of(&text, "run.flags", "ingest")?)));
    }
    if stage == LIMITS {
        let states = |line: &str| line.contains(&format!("\"{key}\""));
        return Some(in_file(&own, text.lines().position(states)? + 1));
    }
    if let what @ ("flags" | "program") = key {
        return Some(in_file(&own, line_of(&text, &format!("run.{what}"), stage)?));
    }
    let named = Path::new("pipelines").join(format!("{}.toml", pipeline.name()?));
    let first = key.split('.').next()?;
    let value = |pipeline: &Pipeline| json!(pipeline.table(stage).and_then(|table| table.get(first)));
    let states_it = Pipeline::read(&named, None).is_ok_and(|project| value(&project) == value(&pipeline));
    let of_project = || line_of(&fs::read_to_string(&named).ok().filter(|_| states_it)?, stage, key);
    of_project().map(|line| in_file(&named, line)).or_else(|| Some(in_file(&own, line_of(&text, stage, key)?)))
}

/// What people write for a field of the test, in a file beside the record or in its first lines.
const WRITTEN: [(&str, [&str; 2]); 6] = [
    ("mass_kg", ["mass", "test mass"]),
    ("impact_speed_m_per_s", ["impact speed", "speed"]),
    ("channel", ["channel", "pulse"]),
    ("vehicle", ["vehicle", "car"]),
    ("barrier", ["barrier", "barrier"]),
    ("time_zero_s", ["time zero", "contact"]),
];

/// The line beside or in front of a record that states a field of the test; a flag goes before both.
fn place_of_test(pipeline: &Pipeline, field: &str) -> Option<(String, usize)> {
    /// Lines of a record that may describe it, and bytes of them.
    const HEAD: (usize, u64) = (60, 10_000);
    let (_, written) = WRITTEN.iter().find(|(name, _)| *name == field)?;
    let flag = format!("--{}", written[0].replace(' ', "-"));
    if pipeline.typed("flags", "ingest").is_some_and(|typed| typed.contains(&flag)) {
        return None;
    }
    let record = PathBuf::from(pipeline.record()?);
    [sidecar_of(&record), record].into_iter().find_map(|file| {
        let mut head = String::new();
        fs::File::open(&file).ok()?.take(HEAD.1).read_to_string(&mut head).ok()?;
        let states = |line: &str| {
            let line = line.trim_start_matches(['#', ' ']).to_lowercase().replace(['_', '-'], " ");
            line.split_once([':', '=']).is_some_and(|(key, _)| written.contains(&key.trim()))
        };
        let line = head.lines().take(HEAD.0).position(states)?;
        Some((file.display().to_string(), line + 1))
    })
}

/// Two results of one name; `None`: the side has none.
pub struct Pair {
    pub name: String,
    pub before: Option<FoundRun>,
    pub after: Option<FoundRun>,
}

/// Pairs of results with a name each: two that are named themselves, else the runs of two folders by their names.
/// A model of several tests has no accepted side.
pub fn pairs(a: &Path, b: &Path) -> anyhow::Result<Vec<Pair>> {
    let is_kept =
        |path: &Path| is_json(path) && read_json(path).is_ok_and(|value| Expected::is_schema(&value["schema"]));
    for path in [a, b] {
        fs::metadata(path).map_err(|source| DiffError::Io { path: path.to_owned(), source })?;
    }
    if kind(a) != kind(b) && !is_kept(a) && !is_kept(b) {
        return Err(DiffError::Kinds { a: a.into(), a_is: kind(a), b: b.into(), b_is: kind(b) }.into());
    }
    let is_one = |path: &Path| !path.is_dir() || results_in(path).is_ok();
    if is_one(a) && is_one(b) {
        let named =
            |path: &Path| FoundRun { name: name_of(b), path: path.to_owned(), is_kept: is_kept(path), is_joint: false };
        return Ok(vec![Pair { name: name_of(b), before: Some(named(a)), after: Some(named(b)) }]);
    }
    let left = runs_below(&[a.to_owned()])?;
    let right = runs_below(&[b.to_owned()]).or_else(|error| match error.downcast_ref() {
        // Every record is missing: each is told.
        Some(DiffError::NotARun { .. }) if !is_one(a) => Ok(Vec::new()),
        _ => Err(error),
    })?;
    let with_accepted = left.iter().chain(&right).any(|run| run.is_kept);
    let mut paired: BTreeMap<String, [Option<FoundRun>; 2]> = BTreeMap::new();
    for (side, runs) in [left, right].into_iter().enumerate() {
        for run in runs.into_iter().filter(|run| !(with_accepted && run.is_joint)) {
            let name = run.name.clone();
            paired.entry(name).or_default()[side] = Some(run);
        }
    }
    let pairs = paired.into_iter().map(|(name, [before, after])| Pair { name, before, after });
    // Of one run and a folder only that run is asked for.
    let is_asked = |pair: &Pair| (pair.before.is_some() || !is_one(a)) && (pair.after.is_some() || !is_one(b));
    Ok(pairs.filter(is_asked).collect())
}

fn kind(path: &Path) -> &'static str {
    match (path.is_dir(), is_json(path)) {
        (true, _) => "a folder",
        (_, true) => "a JSON file",
        _ => "a file",
    }
}

/// The reports of all files of two results.
pub fn files(a: &Path, b: &Path, settings: &CompareSettings) -> Result<Vec<FileReport>, DiffError> {
    let mut settings = settings.clone();
    // Of a run the fits come before what is made of them.
    let mut file = |name: &str, a: &Path, b: &Path| -> Result<FileReport, DiffError> {
        if is_json(a) {
            // The summary's tolerances apply under whatever name it was kept.
            return Ok(FileReport::json(name, compare_json(SUMMARY, &read_json(a)?, &read_json(b)?, &settings)));
        }
        let (a, b) = (Artifact::open(a)?, Artifact::open(b)?);
        settings.tolerances.open.extend(open_candidates(&a, &b)?);
        Ok(compare_artifacts(name, &a, &b, &settings)?)
    };
    if !a.is_dir() {
        return Ok(vec![file(&a.file_name().unwrap_or_default().to_string_lossy(), a, b)?]);
    }
    let (left, right) = (results_in(a)?, results_in(b)?);
    left.union(&right)
        .map(|name| match (left.contains(name), right.contains(name)) {
            (true, true) => file(name, &a.join(name), &b.join(name)),
            (true, false) => Ok(FileReport::missing(name, OnlyIn::A)),
            _ => Ok(FileReport::missing(name, OnlyIn::B)),
        })
        .collect()
}

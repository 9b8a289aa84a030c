//! `--index`: many run folders as a table on one page.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

use crate::{IndexedRun, OF_SEVERAL_TESTS, RunIndex, Summary, pulse_line};
use crumple_artifact::{Artifact, OutputKind};
use crumple_diff::DiffError;
use crumple_stage::{
    ChainStage, ExitStatus, Pipeline, Refused, Usage, by_way, chain, program, refuse_to_overwrite, say, told_apart,
};

use super::compare::write;
use super::run_folders::{address, runs_below};

/// Most folders that an error names.
const NAMED: usize = 5;

/// Reads the summaries of run folders and writes the page. Rows are in the order of the names of the runs.
pub fn index(inputs: &[PathBuf], page: &Path, quiet: bool) -> anyhow::Result<ExitStatus> {
    let folders = run_folders(inputs)?;
    let summaries: Vec<PathBuf> = folders.iter().map(|folder| folder.join("summary.json")).collect();
    refuse_missing(&folders)?;
    refuse_to_overwrite(page, OutputKind::Report, &summaries)?;
    let mut named: Vec<(String, &PathBuf, Option<Summary>)> = Vec::new();
    for ((name, folder), summary) in told_apart(&folders).into_iter().zip(&folders).zip(&summaries) {
        named.push((name, folder, summary.is_file().then(|| read(summary)).transpose()?));
    }
    named.sort_by(|a, b| (&a.0, a.1).cmp(&(&b.0, b.1)));
    let mut runs = Vec::new();
    for (name, folder, summary) in &named {
        let (exit_code, error) = ending(folder, summary.as_ref());
        runs.push(IndexedRun {
            name: name.clone(),
            variant: String::new(),
            report: address(page, &folder.join("report.html")),
            exit_code,
            error,
            summary: summary.as_ref(),
            pulse: summary.as_ref().map_or_else(String::new, |summary| pulse(folder, summary)),
        });
    }
    let index = RunIndex { title: "", tables: &[], runs: &runs, figures: Vec::new() };
    write(page, OutputKind::Report, &index.to_html())?;
    if !quiet {
        say(index.counted());
        say(page.display());
    }
    Ok(ExitStatus::Done)
}

/// The folders that are named, those in lists among them, each once.
fn run_folders(inputs: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let mut folders: Vec<PathBuf> = Vec::new();
    for input in inputs {
        let typed = input.to_string_lossy();
        let list = match typed.strip_prefix('@') {
            Some(list) => Some(PathBuf::from(list)),
            None => input.is_file().then(|| input.clone()),
        };
        match list {
            Some(list) => folders.extend(listed(&list)?),
            // A folder that is no run may hold some, by the rule of accept and diff.
            None if input.is_dir() && !is_of_a_run(input) => match runs_below(std::slice::from_ref(input)) {
                Ok(below) => {
                    folders.extend(below.into_iter().filter(|run| !run.is_kept && !run.is_joint).map(|run| run.path));
                }
                Err(error) if error.is::<DiffError>() => folders.push(input.clone()),
                Err(error) => return Err(error),
            },
            None => folders.push(input.clone()),
        }
    }
    let mut seen = BTreeSet::new();
    let plain = |folder: &PathBuf| -> PathBuf {
        folder.components().filter(|part| !matches!(part, Component::CurDir)).collect()
    };
    folders.retain(|folder| seen.insert(plain(folder)));
    if folders.is_empty() {
        return Err(Usage::new("the lists name no run folder")
            .hint("a list has the path of a run folder a line")
            .into());
    }
    Ok(folders)
}

/// The paths in a list, a line each, relative to the list; empty lines and those that begin with # are passed over.
fn listed(list: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let hint = "a list is a text file with the path of a run folder a line";
    let text = fs::read_to_string(list)
        .map_err(|error| Usage::new(format!("cannot read the list {}: {error}", list.display())).hint(hint))?;
    let beside = list.parent().unwrap_or(Path::new(""));
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    Ok(lines.map(|line| beside.join(line)).collect())
}

/// How the last run into a folder ended: its exit code and, where that is not 0, why.
fn ending(folder: &Path, summary: Option<&Summary>) -> (i32, String) {
    let failed = Pipeline::failure_in(folder).map(i32::from);
    match (summary, failed) {
        (Some(_), Some(code)) => {
            (code, "the last run ended before its report: the numbers are those of the run before".to_owned())
        }
        (Some(summary), None) => IndexedRun::ending(summary),
        (None, code) => {
            let is_missing = |stage: &ChainStage| {
                !stage.is_optional && stage.outputs.iter().any(|name| !folder.join(name).is_file())
            };
            let stage = chain().find(is_missing).map_or("", |stage| stage.name);
            (code.unwrap_or(ExitStatus::Failure as i32), format!("the run ended at {stage}, before its report"))
        }
    }
}

fn is_of_a_run(folder: &Path) -> bool {
    chain().flat_map(|stage| stage.outputs).chain([Pipeline::OF_A_RUN]).any(|name| folder.join(name).is_file())
}

/// Names folders that are none of a run: a row of nothing would look like one.
fn refuse_missing(folders: &[PathBuf]) -> Result<(), Refused> {
    let missing: Vec<String> =
        folders.iter().filter(|folder| !is_of_a_run(folder)).map(|folder| folder.display().to_string()).collect();
    let named = missing[..missing.len().min(NAMED)].join(", ");
    let found = match missing.len() {
        0 => return Ok(()),
        1 => format!("{named} holds no results of a run"),
        n if n > NAMED => format!("{n} folders hold no results of a run: {named}, ..."),
        n => format!("{n} folders hold no results of a run: {named}"),
    };
    Err(Refused::new(found)
        .expected("run folders")
        .hint(format!("{} RECORD makes one, and says where it is", by_way("just run", "crumple run"))))
}

fn read(path: &Path) -> anyhow::Result<Summary> {
    let refused = |problem: String| Refused::new(problem).hint(format!("write it again: {}", program("report FOLDER")));
    let bytes = fs::read(path).map_err(|error| refused(format!("cannot read {}: {error}", path.display())))?;
    Summary::from_json(&bytes).map_err(|error| {
        let other: Option<serde_json::Value> = serde_json::from_slice(&bytes).ok();
        if other.is_some_and(|summary| summary["schema"] == OF_SEVERAL_TESTS) {
            let folder = path.parent().unwrap_or(path);
            return Refused::new(format!("{} is a model of several tests, not a run", folder.display()))
                .expected("run folders")
                .hint("leave it out, and name the runs of its tests")
                .into();
        }
        refused(format!("{} is no summary of a run: {error}", path.display())).into()
    })
}

/// The filtered pulse of a run folder; empty where there is none.
fn pulse(folder: &Path, summary: &Summary) -> String {
    let Some(channel) = summary.test.channel.as_deref() else { return String::new() };
    let Ok(artifact) = Artifact::open(&folder.join("2-filter.mcap")) else { return String::new() };
    artifact.waves().get(channel).map(|wave| pulse_line(&wave.sampled)).unwrap_or_default()
}

//! `--compare`: several runs on one page.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::compare::first_screen::shell_word;
use crate::{ComparedRun, RunComparison};
use anyhow::Context;
use crumple_artifact::{OutputKind, write_atomically};
use crumple_stage::{
    Call, ExitStatus, Inputs, Pipeline, Usage, artifacts_of_a_run, by_way, columns, keep_budget, load_artifacts,
    refuse_to_overwrite, say, told_apart, wrapped,
};

use super::gather::gather;
use super::results::limits_of;
use super::run_folders::address;

/// Reads a run folder; what is written is not one of its files.
pub fn read_run(folder: &Path, name: String, page: &Path) -> anyhow::Result<(ComparedRun, Inputs)> {
    let artifacts = artifacts_of_a_run(folder)?;
    let is_earlier = Pipeline::failure_in(folder).is_some();
    let name = if is_earlier { format!("{name} (results of an earlier run)") } else { name };
    refuse_to_overwrite(page, OutputKind::Report, &artifacts)?;
    keep_budget(&artifacts, ExitStatus::Refused);
    let note = Some(folder.join(Pipeline::OF_A_RUN)).filter(|note| note.is_file());
    let pipeline = note.map(|note| Pipeline::read(&note, None)).transpose()?;
    let inputs = load_artifacts(&artifacts)?.input;
    let mut run = gather(&inputs, pipeline.as_ref())?.with_sentences_shown();
    let limits = pipeline.as_ref().map(limits_of).unwrap_or_default();
    run.pipeline = pipeline.and_then(|pipeline| pipeline.name().map(str::to_owned));
    let report = address(page, &folder.join("report.html"));
    Ok((ComparedRun { limits, ..ComparedRun::new(name, report, run) }, inputs))
}

/// Errors: fewer than two runs.
pub fn refuse_one_run(folders: &[PathBuf]) -> anyhow::Result<()> {
    if folders.len() < 2 {
        return Err(Usage::new("one run has nothing to be compared with").hint("name two run folders or more").into());
    }
    Ok(())
}

/// The command that was typed, to be typed again.
pub fn as_typed(call: &Call) -> String {
    let words = call.words.iter().map(|word| word.to_string_lossy()).filter(|word| word != "--compare");
    let command = by_way("just compare", "crumple compare").to_owned();
    words.fold(command, |typed, word| typed + " " + &shell_word(&word))
}

/// Reads run folders and writes the page that compares them, and its tables as Markdown where asked for.
pub fn compare(
    folders: &[PathBuf],
    page: &Path,
    markdown: Option<&Path>,
    quiet: bool,
    call: &Call,
) -> anyhow::Result<ExitStatus> {
    refuse_one_run(folders)?;
    let mut runs = Vec::new();
    for (folder, name) in folders.iter().zip(told_apart(folders)) {
        runs.push(read_run(folder, name, page)?.0);
    }
    let comparison = RunComparison::new(&runs)?;
    write(page, OutputKind::Report, &comparison.to_html())?;
    if let Some(path) = markdown {
        write(path, OutputKind::Markdown, &comparison.to_markdown(&as_typed(call)))?;
    }
    if !quiet {
        let columns = columns();
        comparison.sentences().iter().flat_map(|text| wrapped(text, columns)).for_each(say);
        comparison.lines().iter().for_each(say);
        say(page.display());
    }
    Ok(ExitStatus::Done)
}

/// A file in one piece.
pub fn write(path: &Path, kind: OutputKind, text: &str) -> anyhow::Result<()> {
    write_atomically(path, kind, |file| file.write_all(text.as_bytes()))
        .with_context(|| format!("cannot write {}", path.display()))
}

//! `crumple accept`: what of a run is kept in `expected/`.

use std::fs;
use std::path::PathBuf;

use crumple_artifact::OutputKind;
use crumple_stage::{
    ExitStatus, Program, Usage, keep_budget, printable, results_of_an_earlier_run, run_tool, say, to_stdout,
};

use super::compare::write;
use super::diff::trouble;
use super::results::Side;
use super::run_folders::{FoundRun, SUMMARY, runs_below};
use crate::compare::expected::Expected;

/// Keeps what people decide by of runs: expected/RECORD.json, a small file each, for a repository.
#[derive(Debug, clap::Parser)]
#[command(name = "crumple-accept", version)]
struct AcceptArgs {
    /// Run folders, or folders of runs.
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<PathBuf>,
    /// Folder to write to.
    #[arg(long, value_name = "FOLDER", default_value = "expected")]
    into: PathBuf,
}

/// `crumple accept`.
pub const ACCEPT: Program =
    Program::of_tool::<AcceptArgs>("accept", |call| run_tool(call, |args: AcceptArgs| accept(&args).map_err(trouble)));

/// All or nothing: one run that cannot be accepted, and nothing is written.
fn accept(args: &AcceptArgs) -> anyhow::Result<ExitStatus> {
    keep_budget(&args.runs, ExitStatus::Usage);
    let (joint, runs): (Vec<FoundRun>, Vec<FoundRun>) =
        runs_below(&args.runs)?.into_iter().partition(|run| run.is_joint && !args.runs.contains(&run.path));
    let kept = runs.iter().map(|run| Ok((run, kept_of(run)?))).collect::<anyhow::Result<Vec<_>>>()?;
    let mut text = String::new();
    for (run, kept) in kept {
        let json = serde_json::to_string_pretty(&kept)? + "\n";
        let path = args.into.join(format!("{}.json", run.name));
        let is_there = fs::read_to_string(&path).is_ok_and(|old| old == json);
        if !is_there {
            write(&path, OutputKind::Summary, &json)?;
        }
        text += &format!("{}{}\n", path.display(), if is_there { ", as it was" } else { "" });
    }
    for run in joint {
        say(format_args!("note: {} is a model of several tests, no run: left out", run.path.display()));
    }
    to_stdout(printable(&text).as_bytes())?;
    Ok(ExitStatus::Done)
}

/// What is kept of a run. Errors: it failed, is no run, or is made of two.
fn kept_of(run: &FoundRun) -> anyhow::Result<Expected> {
    let folder = run.path.display();
    let refused = |problem: String, hint: &str| Usage::new(format!("{problem}; nothing was written")).hint(hint);
    if let Some(problem) = results_of_an_earlier_run(&run.path) {
        return Err(refused(problem, "run the record again, and see why it ends").into());
    }
    let read = Side::read(&run.path)?;
    if run.is_kept || run.is_joint || read.kept.stages.is_empty() {
        return Err(
            refused(format!("{folder} is no run folder"), "accept takes the folders that crumple run made").into()
        );
    }
    read.refuse_a_mixture()?;
    let Expected { summary, .. } = &read.kept;
    if summary.key_numbers.is_empty() && summary.recommended.is_none() && summary.models.is_empty() {
        let problem = format!("{folder} has no {SUMMARY} with results");
        return Err(refused(problem, "run the record again, and look at its report").into());
    }
    Ok(Expected::of_run(read.kept))
}
